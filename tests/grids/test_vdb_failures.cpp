// What becomes of bad files, full disks and names that clash: the whole text of every message.
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/stat.h>

#include <algorithm>
#include <csignal>
#include <cstring>
#include <limits>
#include <random>

#include "estara/grids/texture_grid.h"
#include "estara/grids/vdb_sampler.h"
#include "estara/scenes/error.h"
#include "example_grids.h"

namespace estara {
namespace {

std::string read_error(const std::string& path) {
    return error_of([&] { read_vdb(path); });
}

/// The bytes of a small baked file.
std::string small_file(const TemporaryFolder& folder) {
    write_vdb(folder.file("whole.vdb"), {complete_grid("", 0.2)}, {});
    return read_bytes(folder.file("whole.vdb"));
}

void replace_all(std::string& text, const std::string& from, const std::string& to) {
    for (std::size_t at = text.find(from); at != std::string::npos; at = text.find(from, at)) {
        text.replace(at, from.size(), to);
    }
}

TEST(ReadVdb, SaysThatAFileIsMissing) {
    const TemporaryFolder folder;
    EXPECT_EQ(read_error(folder.file("a.vdb")), folder.file("a.vdb") + ": no such file");
    EXPECT_EQ(read_error(folder.file("")), folder.file("") + ": not a file");
    EXPECT_EQ(error_of([&] { VdbSampler s(folder.file("a.vdb"), ""); }),
              folder.file("a.vdb") + ": no such file");
}

TEST(ReadVdb, SaysThatAFileIsNoVdb) {
    const TemporaryFolder folder;
    const std::string path = folder.file("a.vdb");
    write_bytes(path, "");
    EXPECT_EQ(read_error(path), path + ": the file is empty");
    write_bytes(path, "BDV");
    EXPECT_EQ(read_error(path), path + ": not a .vdb file");
    write_bytes(path, std::string(100'000, 'x'));
    EXPECT_EQ(read_error(path), path + ": not a .vdb file");
}

TEST(ReadVdb, SaysThatAFileIsCutShort) {
    const TemporaryFolder folder;
    const std::string bytes = small_file(folder), path = folder.file("a.vdb");
    for (int i = 0; i < 50; ++i) {
        const std::size_t length = 8 + (bytes.size() - 8) * std::size_t(i * i) / (50 * 50);
        write_bytes(path, bytes.substr(0, length));
        const std::string text = read_error(path);
        const std::string begin =
            path + ": cut short: " + std::to_string(length) + " bytes of at least ";
        EXPECT_EQ(text.substr(0, begin.size()), begin);
        EXPECT_EQ(text.substr(text.size() - 15), "; bake it again");
    }
    write_bytes(path, bytes.substr(0, bytes.size() - 1));
    EXPECT_EQ(read_error(path), path + ": cut short: " + std::to_string(bytes.size() - 1) +
                                    " bytes of at least " + std::to_string(bytes.size()) +
                                    "; bake it again");
}

TEST(ReadVdb, NoticesAnyChangedByte) {
    const TemporaryFolder folder;
    const std::string bytes = small_file(folder), path = folder.file("a.vdb");
    const auto is_random_id = [](std::size_t at) { return at >= 21 && at < 57; };
    for (std::size_t at = 0; at < bytes.size(); at += at < 400 ? 1 : 997) {
        if (is_random_id(at)) continue;
        std::string changed = bytes;
        changed[at] = char(changed[at] ^ 0x41);
        write_bytes(path, changed);
        // Without its name the digest is not found; all else is still as it was.
        const std::size_t key = bytes.find("estara_digest");
        if (at + 4 >= key && at < key + 13 + 4 + 6 + 4) continue;
        EXPECT_THROW(read_vdb(path), Error) << "byte " << at;
    }
    std::string changed = bytes;
    changed[bytes.size() / 2] ^= 1;
    write_bytes(path, changed);
    EXPECT_EQ(read_error(path),
              path + ": damaged: its bytes are not those that were written; bake it again");
}

TEST(ReadVdb, SurvivesAnyChangedByteOfAFileWithoutDigest) {
    const TemporaryFolder folder;
    std::string bytes = small_file(folder);
    const std::string path = folder.file("a.vdb");
    replace_all(bytes, "estara_digest", "unknown_thing");
    write_bytes(path, bytes);
    read_vdb(path);
    int refused = 0;
    for (std::size_t at = 0; at < bytes.size(); at += 211) {
        for (const char change : {char(0x01), char(0x80), char(0xff)}) {
            std::string changed = bytes;
            changed[at] = char(changed[at] ^ change);
            write_bytes(path, changed);
            try {
                read_vdb(path);
            } catch (const Error&) {
                ++refused;
            }
        }
    }
    EXPECT_GT(refused, 10);
}

TEST(ReadVdb, RefusesVoxelsThatAreNotThere) {
    const TemporaryFolder folder;
    TextureGrid grid = complete_grid("", 0.2);
    for (float& value : grid.levels[0].planes[3]) value = 0.5f;  // which zip packs
    write_vdb(folder.file("whole.vdb"), {grid}, {});
    std::string bytes = read_bytes(folder.file("whole.vdb"));
    const std::string path = folder.file("a.vdb");
    replace_all(bytes, "estara_digest", "unknown_thing");
    const std::string packed = "\x78\x01";  // how a zlib stream begins
    const std::size_t at = bytes.find(packed, bytes.find("specular", bytes.find("Tree_float")));
    ASSERT_NE(at, std::string::npos);
    const auto with = [&](std::size_t where, const std::string& what) {
        write_bytes(path, std::string(bytes).replace(where, what.size(), what));
        return read_error(path);
    };
    const std::string damaged = path + ": grid \"specular\" is damaged; bake it again";
    EXPECT_EQ(with(at, "\x79"), damaged);                               // no zlib stream
    EXPECT_EQ(with(at - 8, std::string(8, '\x7f')), damaged);           // a size beyond the file
    EXPECT_EQ(with(at - 8, std::string(8, '\x80')), damaged);           // and of plain values
    EXPECT_EQ(with(at - 8, std::string(8, '\0')), damaged);             // nothing
    EXPECT_EQ(with(at - 8 - 1 - 64, std::string(8, '\x55')), damaged);  // other voxels
}

TEST(ReadVdb, RefusesAValueThatIsNotANumber) {
    const TemporaryFolder folder;
    TextureGrid grid = complete_grid("", 0.2);
    std::minstd_rand random;  // what zip cannot pack
    for (float& value : grid.levels[0].planes[3]) value = float(random());
    const std::string known("\x12\x34\x56\x3f", sizeof(float));
    std::memcpy(&grid.levels[0].planes[3][7], known.data(), known.size());
    write_vdb(folder.file("whole.vdb"), {grid}, {});
    std::string bytes = read_bytes(folder.file("whole.vdb"));
    const std::string path = folder.file("a.vdb");
    ASSERT_NE(bytes.find(known), std::string::npos);
    replace_all(bytes, known, std::string("\0\0\xc0\x7f", sizeof(float)));
    write_bytes(path, bytes);
    EXPECT_EQ(read_error(path),
              path + ": damaged: its bytes are not those that were written; bake it again");
    replace_all(bytes, "estara_digest", "unknown_thing");
    write_bytes(path, bytes);
    EXPECT_EQ(read_error(path),
              path + ": grid \"specular\" has a value that is not finite; bake it again");
}

TEST(ReadVdb, SaysThatAFormatIsUnknown) {
    const TemporaryFolder folder;
    std::string bytes = small_file(folder);
    const std::string path = folder.file("a.vdb");
    bytes[8] = char(221);
    write_bytes(path, bytes);
    EXPECT_EQ(read_error(path), path + ": .vdb format 221; this program reads 222 to 224");
}

TEST(ReadVdb, ListsTheGridsOfAFileOfSomebodyElse) {
    const TemporaryFolder folder;
    std::string bytes = small_file(folder);
    const std::string path = folder.file("a.vdb");
    replace_all(bytes, "estara_", "unknown");
    write_bytes(path, bytes);
    EXPECT_EQ(read_error(path),
              path +
                  ": not made by estara-bake (no grid has estara_shader); it has: color, "
                  "density, specular, surface");
}

TEST(ReadVdb, SaysWhichMetadataIsMissing) {
    const TemporaryFolder folder;
    std::string bytes = small_file(folder);
    const std::string path = folder.file("a.vdb");
    replace_all(bytes, "estara_digest", "unknown_thing");
    replace_all(bytes, "estara_voxel_size", "estara_pixel_size");
    write_bytes(path, bytes);
    EXPECT_EQ(read_error(path),
              path + ": grid \"color\" has no valid estara_voxel_size; bake it again");
}

TEST(ReadVdb, PassesOnWhatOpenVdbSaysOfDamagedVoxels) {
    const TemporaryFolder folder;
    std::string bytes = small_file(folder);
    const std::string path = folder.file("a.vdb");
    replace_all(bytes, "estara_digest", "unknown_thing");
    replace_all(bytes, "UniformScaleTranslateMap", "UniformScaleTranslateCap");
    write_bytes(path, bytes);
    EXPECT_EQ(read_error(path), path +
                                    ": damaged: Map UniformScaleTranslateCap is not registered; "
                                    "bake it again");
}

TEST(ReadVdb, BelievesNoLengthInATransform) {
    const TemporaryFolder folder;
    std::string bytes = small_file(folder);
    const std::string path = folder.file("a.vdb");
    replace_all(bytes, "estara_digest", "unknown_thing");
    bytes.replace(bytes.find("UniformScaleTranslateMap") - 4, 4, "\xff\xff\xff\xff");
    write_bytes(path, bytes);
    EXPECT_EQ(read_error(path), path + ": damaged: a grid's metadata are cut short; bake it again");
}

TEST(ReadVdb, SaysWhichGridIsMissing) {
    const TemporaryFolder folder;
    write_vdb(folder.file("whole.vdb"), {complete_grid("", 0.1)}, {});
    std::string bytes = read_bytes(folder.file("whole.vdb"));
    const std::string path = folder.file("a.vdb");
    replace_all(bytes, "estara_digest", "unknown_thing");
    replace_all(bytes, "specular_level_1", "specular_level_7");
    write_bytes(path, bytes);
    EXPECT_EQ(read_error(path), path + ": grid \"specular_level_1\" is missing; bake it again");
}

TEST(WriteVdb, RefusesNamesThatWouldClash) {
    const TemporaryFolder folder;
    const std::string path = folder.file("a.vdb");
    EXPECT_EQ(error_of([&] {
                  write_vdb(path, {complete_grid("a", 0.1), complete_grid("a_level_1", 0.1)}, {});
              }),
              path + ": two grids would be called \"color_a_level_1\"; rename an object");
    EXPECT_TRUE(folder.entries().empty());
}

TEST(WriteVdb, RefusesWhatIsNotANumber) {
    const TemporaryFolder folder;
    const std::string path = folder.file("a.vdb");
    TextureGrid grid = complete_grid("vase", 0.1);
    grid.levels[0].planes[1][7] = std::numeric_limits<float>::infinity();
    EXPECT_EQ(
        error_of([&] { write_vdb(path, {grid}, {}); }),
        path + ": object \"vase\": channel \"color\" has a value on level 0 that is not finite");
}

TEST(WriteVdb, RefusesNothing) {
    const TemporaryFolder folder;
    const std::string path = folder.file("a.vdb");
    EXPECT_EQ(error_of([&] { write_vdb(path, {}, {}); }), path + ": there is nothing to write");
    EXPECT_EQ(error_of([&] { write_vdb(path, {TextureGrid{}}, {}); }),
              path + ": there are no voxels to write");
}

/// Lets no file grow beyond a size while it lives: what a full disk looks like to a program.
class SmallDisk {
public:
    explicit SmallDisk(rlim_t bytes) {
        m_signal = std::signal(SIGXFSZ, SIG_IGN);
        getrlimit(RLIMIT_FSIZE, &m_before);
        const rlimit limit{bytes, m_before.rlim_max};
        setrlimit(RLIMIT_FSIZE, &limit);
    }
    ~SmallDisk() {
        setrlimit(RLIMIT_FSIZE, &m_before);
        std::signal(SIGXFSZ, m_signal);
    }
    SmallDisk(const SmallDisk&) = delete;
    SmallDisk& operator=(const SmallDisk&) = delete;

private:
    rlimit m_before{};
    void (*m_signal)(int) = nullptr;
};

TEST(WriteVdb, LeavesNothingBehindWhenTheDiskIsFull) {
    const TemporaryFolder folder;
    const std::string path = folder.file("a.vdb");
    const TextureGrid grid = complete_grid();
    for (const int bytes : {0, 10, 100, 1'000, 20'000}) {
        std::string text;
        ExitStatus status = ExitStatus::done;
        {
            const SmallDisk disk(static_cast<rlim_t>(bytes));
            try {
                write_vdb(path, {grid}, {});
            } catch (const Error& e) {
                text = e.what();
                status = e.status();
            }
        }
        EXPECT_EQ(text, path + ": the disk is full or the file was cut short: only " +
                            std::to_string(bytes) + " bytes arrived");
        EXPECT_EQ(status, ExitStatus::failed);
        EXPECT_TRUE(folder.entries().empty());
    }
}

TEST(WriteVdb, LeavesTheOldFileWhenTheDiskIsFull) {
    const TemporaryFolder folder;
    const std::string before = small_file(folder);
    {
        const SmallDisk disk(1'000);
        EXPECT_THROW(write_vdb(folder.file("whole.vdb"), {complete_grid()}, {}), Error);
    }
    EXPECT_TRUE(read_bytes(folder.file("whole.vdb")) == before);
    EXPECT_EQ(folder.entries(), std::vector<std::string>{"whole.vdb"});
}

TEST(WriteVdb, NamesAFolderThatCannotBeWrittenTo) {
    const TemporaryFolder folder;
    write_bytes(folder.file("plain"), "a file");
    const std::string path = folder.file("plain") + "/a.vdb";
    try {
        write_vdb(path, {complete_grid("", 0.2)}, {});
        FAIL() << "it was written";
    } catch (const Error& e) {
        EXPECT_EQ(e.status(), ExitStatus::bad_input);
        EXPECT_EQ(std::string(e.what()),
                  path + ": cannot make the folder " + folder.file("plain") + ": Not a directory");
    }
    EXPECT_EQ(folder.entries(), std::vector<std::string>{"plain"});
}

}  // namespace
}  // namespace estara
