// An image file as a test sees it.
#pragma once

#include <OpenImageIO/imageio.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace estara::test {

/// An image file, all its channels as floats.
struct ReadImage {
    OIIO::ImageSpec spec;
    std::vector<float> pixels;
    float at(int pixel, const std::string& channel) const {
        return pixels[std::size_t(pixel * spec.nchannels + spec.channelindex(channel))];
    }
};

/// Empty if there is no such image.
inline ReadImage read_image(const std::string& path) {
    const auto input = OIIO::ImageInput::open(path);
    if (!input) return {};
    ReadImage image{input->spec(), {}};
    image.pixels.resize(image.spec.image_pixels() * std::size_t(image.spec.nchannels));
    EXPECT_TRUE(input->read_image(0, 0, 0, -1, OIIO::TypeFloat, image.pixels.data()));
    return image;
}

}  // namespace estara::test
