// Memory in pages of 2 MiB, if the system gives them: it is had in fewer steps, and reads in no
// order find their page faster.
#pragma once

#include <sys/mman.h>

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <memory>

namespace estara {

inline constexpr std::size_t large_page = std::size_t{2} << 20;  // bytes

/// Asks for large pages where they fit into memory that nobody has touched yet.
inline void prefer_large_pages(void* memory, std::size_t bytes) noexcept {
    const auto start = reinterpret_cast<std::uintptr_t>(memory);
    const std::uintptr_t from = (start + large_page - 1) / large_page * large_page;
    const std::uintptr_t to = (start + bytes) / large_page * large_page;
    if (from >= to) return;
    madvise(static_cast<char*>(memory) + (from - start), to - from, MADV_HUGEPAGE);
}

struct FreeMemory {
    void operator()(void* memory) const noexcept { std::free(memory); }
};

template <class T>
using LargePages = std::unique_ptr<T[], FreeMemory>;

/// Memory for so many T of a plain type, which the system gives as it is touched; null if there is
/// none to be had.
template <class T>
LargePages<T> allocate_large_pages(std::size_t count) noexcept {
    const std::size_t bytes = (count > 0 ? count : 1) * sizeof(T);
    const std::size_t align = bytes < large_page ? 64 : large_page;
    const std::size_t rounded = (bytes + align - 1) / align * align;
    LargePages<T> memory(static_cast<T*>(std::aligned_alloc(align, rounded)));
    if (memory) prefer_large_pages(memory.get(), rounded);
    return memory;
}

}  // namespace estara
