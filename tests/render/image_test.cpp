#include "estara/render/image_file.h"

#include <OpenImageIO/imageio.h>
#include <gtest/gtest.h>

#include <map>

#include "estara/render/image_queue.h"
#include "read_image.h"
#include "small_scene.h"

namespace estara {
namespace {

using test::error_of;
using test::Folder;
using test::read_image;
using test::ReadImage;

/// A film whose every value tells where it is.
Film numbered_film() {
    Film film(5, 3, {true, true, true, true});
    for (std::size_t i = 0; i < film.color.size(); ++i) {
        const float v = float(i) / 16.0f;
        film.color[i] = {v, v + 1.0f, v + 2.0f, 0.5f};
        film.albedo[i] = {v + 3.0f, v + 4.0f, v + 5.0f};
        film.N[i] = {v - 1.0f, v - 2.0f, v - 3.0f};
        film.P[i] = {v + 1000.001f, v + 2000.001f, v + 3000.001f};
        film.depth[i] = v + 100000.1f;
    }
    return film;
}

TEST(Exr, HasTheNamedChannelsInTheirTypes) {
    const Folder folder;
    write_image(folder / "a.exr", ImageFormat::exr, numbered_film());
    const ReadImage image = read_image(folder / "a.exr");
    std::map<std::string, OIIO::TypeDesc> types;
    for (int c = 0; c < image.spec.nchannels; ++c) {
        types[image.spec.channelnames[std::size_t(c)]] = image.spec.channelformat(c);
    }
    const OIIO::TypeDesc half = OIIO::TypeHalf, full = OIIO::TypeFloat;
    const std::map<std::string, OIIO::TypeDesc> expected{
        {"R", half},        {"G", half},        {"B", half},   {"A", half},   {"albedo.R", half},
        {"albedo.G", half}, {"albedo.B", half}, {"N.X", half}, {"N.Y", half}, {"N.Z", half},
        {"P.X", full},      {"P.Y", full},      {"P.Z", full}, {"Z", full}};
    EXPECT_EQ(types, expected);
}

TEST(Exr, GivesBackWhatWasWritten) {
    const Folder folder;
    const Film film = numbered_film();
    write_image(folder / "a.exr", ImageFormat::exr, film);
    const ReadImage image = read_image(folder / "a.exr");
    ASSERT_EQ(image.spec.width, 5);
    ASSERT_EQ(image.spec.height, 3);
    for (int i = 0; i < 15; ++i) {
        const std::size_t at = std::size_t(i);
        EXPECT_EQ(image.at(i, "R"), film.color[at].r);
        EXPECT_EQ(image.at(i, "B"), film.color[at].b);
        EXPECT_EQ(image.at(i, "A"), 0.5f);
        EXPECT_EQ(image.at(i, "albedo.G"), film.albedo[at].g);
        EXPECT_EQ(image.at(i, "N.Z"), film.N[at].z);
        EXPECT_EQ(image.at(i, "P.Y"), film.P[at].y);
        EXPECT_EQ(image.at(i, "Z"), film.depth[at]);
    }
}

TEST(Exr, KeepsWhatIsTooBrightForAHalfFinite) {
    const Folder folder;
    Film film(1, 1, {});
    film.color[0] = {1e9f, 1.0f, 1.0f, 1.0f};
    write_image(folder / "a.exr", ImageFormat::exr, film);
    EXPECT_EQ(read_image(folder / "a.exr").at(0, "R"), 65504.0f);
}

TEST(Png, HoldsSrgbWithAlphaNotAssociated) {
    const Folder folder;
    Film film(4, 1, {});
    film.color = {{0.5f, 0.0f, 1.0f, 1.0f},
                  {0.25f, 0.25f, 0.25f, 0.5f},  // half covered by 0.5
                  {0.002f, 7.0f, -1.0f, 1.0f},
                  {0.0f, 0.0f, 0.0f, 0.0f}};
    write_image(folder / "a.png", ImageFormat::png, film);
    OIIO::ImageSpec raw;
    raw.attribute("oiio:UnassociatedAlpha", 1);
    const auto input = OIIO::ImageInput::open(folder / "a.png", &raw);
    ASSERT_TRUE(input);
    std::vector<unsigned char> bytes(16);
    ASSERT_TRUE(input->read_image(0, 0, 0, -1, OIIO::TypeUInt8, bytes.data()));
    // IEC 61966-2-1: 0.5 is 188; 0.002 * 12.92 * 255 = 6.6.
    const std::vector<unsigned char> expected{188, 0,   255, 255, 188, 188, 188, 128,
                                              7,   255, 0,   255, 0,   0,   0,   0};
    EXPECT_EQ(bytes, expected);
}

TEST(ImageFile, FailsWhereNoFolderCanBe) {
    const Folder folder;
    std::ofstream(folder / "file") << "x";
    const std::string path = folder / "file/a.png";
    const std::string text =
        error_of([&] { write_image(path, ImageFormat::png, numbered_film()); });
    EXPECT_NE(text, "no error");
    EXPECT_NE(text.find(folder / "file"), std::string::npos) << text;
}

TEST(ImageQueue, WritesEveryFilmInEveryPattern) {
    const Folder folder;
    ImageQueue queue;
    const std::vector<FilePattern> patterns{FilePattern(folder / "##.exr"),
                                            FilePattern(folder / "##.png")};
    for (int frame = 1; frame <= 7; ++frame) {
        Film film(2, 2, {});
        film.color.assign(4, glm::vec4(float(frame)));
        queue.push(std::move(film), frame, patterns);
    }
    queue.finish();
    for (int frame = 1; frame <= 7; ++frame) {
        EXPECT_EQ(read_image(patterns[0].path(frame)).at(3, "R"), float(frame));
        EXPECT_TRUE(std::filesystem::exists(patterns[1].path(frame)));
    }
}

TEST(ImageQueue, ThrowsWhatWritingThrewAndWritesNoMore) {
    const Folder folder;
    std::ofstream(folder / "file") << "x";
    ImageQueue queue;
    queue.push(Film(2, 2, {}), 1, {FilePattern(folder / "file/#.png")});
    EXPECT_THROW(queue.finish(), Error);
    queue.push(Film(2, 2, {}), 2, {FilePattern(folder / "#.png")});
    queue.finish();
    EXPECT_FALSE(std::filesystem::exists(folder / "2.png"));
}

}  // namespace
}  // namespace estara
