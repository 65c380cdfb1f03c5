// Files made by tests, and the messages of what fails.
#pragma once

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <string>

#include "estara/scenes/error.h"

namespace estara::test {

/// A folder of the test's own, removed at its end. The test works in it, so that the names of its
/// files, which messages contain, are short.
class InFolder : public ::testing::Test {
protected:
    void SetUp() override {
        m_before = std::filesystem::current_path();
        const auto* info = ::testing::UnitTest::GetInstance()->current_test_info();
        m_folder = std::filesystem::temp_directory_path() /
                   (std::string("estara_") + info->test_suite_name() + "_" + info->name() + "_" +
                    std::to_string(::getpid()));
        std::filesystem::create_directories(m_folder);
        std::filesystem::current_path(m_folder);
    }
    void TearDown() override {
        std::filesystem::current_path(m_before);
        std::filesystem::remove_all(m_folder);
    }

private:
    std::filesystem::path m_before, m_folder;
};

inline void write_file(const std::string& name, const std::string& contents) {
    std::ofstream file(name, std::ios::binary);
    file.write(contents.data(), std::streamsize(contents.size()));
    ASSERT_TRUE(file.flush().good()) << name;
}

/// What the Error thrown by f says; "no error" if there is none.
template <class F>
std::string message_of(F f) {
    try {
        f();
    } catch (const Error& error) {
        return error.what();
    }
    return "no error";
}

}  // namespace estara::test
