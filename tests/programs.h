// What the tests that run the programs share: commands, temporary folders, images.
#pragma once

#include <OpenImageIO/imagebuf.h>
#include <OpenImageIO/imagebufalgo.h>
#include <gtest/gtest.h>
#include <stdlib.h>
#include <sys/wait.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "text_of.h"

namespace estara::test {

/// A folder that is gone with the test. folder / "name" is a path in it.
class TemporaryFolder {
public:
    TemporaryFolder() {
        std::string name = (std::filesystem::temp_directory_path() / "estara-XXXXXX").string();
        if (mkdtemp(name.data()) == nullptr) throw std::runtime_error(name + ": cannot be made");
        m_path = name;
    }
    ~TemporaryFolder() {
        std::error_code gone_already;
        std::filesystem::remove_all(m_path, gone_already);
    }
    TemporaryFolder(const TemporaryFolder&) = delete;
    TemporaryFolder& operator=(const TemporaryFolder&) = delete;

    const std::string& path() const { return m_path; }
    std::string operator/(const std::string& name) const { return m_path + "/" + name; }

private:
    std::string m_path;
};

struct Ran {
    std::string out, err;
    int status = -1;  ///< as the shell counts: 128 + number for a signal
};

/// Runs lines of bash in a folder, as a user does: the programs are found by their names, $MODELS
/// is the folder of the meshes. Stops at the first line that fails.
inline Ran run_in(const TemporaryFolder& folder, const std::string& lines) {
    const TemporaryFolder spool;
    std::ofstream(spool / "lines")
        << "export PATH=\"" << ESTARA_BIN << ":$PATH\" MODELS=\"" << ESTARA_MODELS << "\" TMP=\""
        << folder.path() << "\" LC_ALL=C.UTF-8 TZ=UTC\ncd \"$TMP\"\n"
        << lines << '\n';
    const std::string command = "bash -e '" + (spool / "lines") + "' >'" + (spool / "out") +
                                "' 2>'" + (spool / "err") + "' </dev/null";
    const int status = std::system(command.c_str());
    return {text_of(spool / "out"), text_of(spool / "err"),
            WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status)};
}

/// run_in() that must succeed.
inline std::string done_in(const TemporaryFolder& folder, const std::string& lines) {
    const Ran ran = run_in(folder, lines);
    EXPECT_EQ(ran.status, 0) << lines << '\n' << ran.out << ran.err;
    return ran.out;
}

/// Path of a mesh; the test fails if the folder of the meshes is not there.
inline std::string model(const std::string& name) {
    const std::string path = std::string(ESTARA_MODELS) + "/" + name;
    EXPECT_TRUE(std::filesystem::exists(path)) << path << " is missing; the build makes it";
    return path;
}

inline nlohmann::json json_of(const std::string& path) {
    return nlohmann::json::parse(text_of(path));
}

/// Names of all files under a folder, sorted, hidden ones too.
inline std::vector<std::string> files_under(const std::string& folder) {
    std::vector<std::string> names;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(folder)) {
        if (entry.is_directory()) continue;
        names.push_back(std::filesystem::relative(entry.path(), folder).string());
    }
    std::sort(names.begin(), names.end());
    return names;
}

/// Names of the folders in a folder that hold a file `command`, sorted: the cases of a driver.
inline std::vector<std::string> cases_in(const std::string& folder) {
    std::vector<std::string> names;
    for (const auto& entry : std::filesystem::directory_iterator(folder)) {
        if (std::filesystem::exists(entry.path() / "command")) {
            names.push_back(entry.path().filename().string());
        }
    }
    std::sort(names.begin(), names.end());
    return names;
}

/// An image file in memory; the test fails if it cannot be read.
class Image {
public:
    explicit Image(const std::string& path) : m_buffer(path) {
        EXPECT_TRUE(m_buffer.read(0, 0, true, OIIO::TypeFloat))
            << path << ": " << m_buffer.geterror();
        OIIO::ImageSpec on_disk;
        if (auto input = OIIO::ImageInput::open(path)) on_disk = input->spec();
        for (int c = 0; c < on_disk.nchannels; ++c) {
            m_formats.push_back(on_disk.channelformat(c).c_str());
        }
    }

    int width() const { return m_buffer.spec().width; }
    int height() const { return m_buffer.spec().height; }
    const std::vector<std::string>& channels() const { return m_buffer.spec().channelnames; }
    /// "half", "float", "uint8", ... of each channel in the file.
    const std::vector<std::string>& formats() const { return m_formats; }
    const OIIO::ImageBuf& buffer() const { return m_buffer; }

    int channel(const std::string& name) const {
        const auto& names = channels();
        const auto found = std::find(names.begin(), names.end(), name);
        EXPECT_NE(found, names.end()) << m_buffer.name() << " has no channel " << name;
        return found == names.end() ? 0 : int(found - names.begin());
    }

    float at(int x, int y, int c) const { return m_buffer.getchannel(x, y, 0, c); }

    /// Three channels that follow each other, from the named one on.
    std::array<float, 3> triple(int x, int y, int first) const {
        return {at(x, y, first), at(x, y, first + 1), at(x, y, first + 2)};
    }

private:
    OIIO::ImageBuf m_buffer;
    std::vector<std::string> m_formats;
};

/// idiff's comparison: `warn` is the share of pixels that differ by more than `fail`.
struct Difference {
    double rmse, max, share;
};

inline Difference difference(const Image& a, const Image& b, float fail = 0.0f) {
    EXPECT_EQ(a.channels(), b.channels());
    EXPECT_EQ(a.width(), b.width());
    EXPECT_EQ(a.height(), b.height());
    const auto found = OIIO::ImageBufAlgo::compare(a.buffer(), b.buffer(), fail, fail);
    return {found.rms_error, found.maxerror,
            double(found.nfail) / (double(a.width()) * double(a.height()))};
}

}  // namespace estara::test
