// A file as text.
#pragma once

#include <fstream>
#include <iterator>
#include <string>

namespace estara::test {

/// All bytes of a file; empty if there is none.
inline std::string text_of(const std::string& path) {
    std::ifstream file(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
}

}  // namespace estara::test
