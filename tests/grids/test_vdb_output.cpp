// What CheckedOutput notices on a disk that does not keep what it is given.
#include <gtest/gtest.h>

#include <filesystem>

#include "estara/scenes/error.h"
#include "example_grids.h"
#include "vdb_output.h"

namespace estara {
namespace {

/// Writes "first, second" and then "FIRST" over the beginning.
CheckedOutput written(const std::string& path) {
    CheckedOutput output(path, "a.vdb");
    output.append("first");
    output.append(", ");
    output.append("second");
    output.replace(0, "FIRST");
    output.close();
    return output;
}

TEST(CheckedOutput, FindsWhatItWrote) {
    const TemporaryFolder folder;
    const CheckedOutput output = written(folder.file("a"));
    EXPECT_EQ(output.size(), 13u);
    EXPECT_EQ(read_bytes(folder.file("a")), "FIRST, second");
    output.check(MappedFile(folder.file("a")));
}

TEST(CheckedOutput, NoticesAnyChangedByte) {
    const TemporaryFolder folder;
    const CheckedOutput output = written(folder.file("a"));
    for (std::size_t at = 0; at < output.size(); ++at) {
        std::string bytes = "FIRST, second";
        bytes[at] = char(bytes[at] ^ 1);
        write_bytes(folder.file("a"), bytes);
        EXPECT_EQ(error_of([&] { output.check(MappedFile(folder.file("a"))); }),
                  "a.vdb: what was read back is not what was written: is the disk faulty?");
    }
}

TEST(CheckedOutput, NoticesAMissingEnd) {
    const TemporaryFolder folder;
    const CheckedOutput output = written(folder.file("a"));
    std::filesystem::resize_file(folder.file("a"), 12);
    EXPECT_EQ(error_of([&] { output.check(MappedFile(folder.file("a"))); }),
              "a.vdb: the disk is full or the file was cut short: only 12 bytes arrived");
}

TEST(CheckedOutput, NoticesAtTheEndThatBytesAreGone) {
    const TemporaryFolder folder;
    CheckedOutput output(folder.file("a"), "a.vdb");
    output.append("first");
    std::filesystem::remove(folder.file("a"));
    write_bytes(folder.file("a"), "");
    EXPECT_EQ(error_of([&] { output.close(); }),
              "a.vdb: the disk is full or the file was cut short: only 0 bytes arrived");
}

}  // namespace
}  // namespace estara
