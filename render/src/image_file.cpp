#include "estara/render/image_file.h"

#include <OpenImageIO/color.h>
#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "estara/scenes/error.h"
#include "estara/scenes/program.h"

namespace estara {
namespace {

/// Channels one after the other in each pixel, as OpenImageIO takes them.
struct ExrPixels {
    OIIO::ImageSpec spec;
    std::vector<float> values;
};

void add_channels(OIIO::ImageSpec& spec, std::initializer_list<const char*> names,
                  OIIO::TypeDesc type) {
    for (const char* name : names) {
        spec.channelnames.emplace_back(name);
        spec.channelformats.push_back(type);
    }
}

OIIO::ImageSpec exr_spec(const Film& film) {
    OIIO::ImageSpec spec(film.width, film.height, 0, OIIO::TypeHalf);
    spec.channelnames.clear();
    add_channels(spec, {"R", "G", "B", "A"}, OIIO::TypeHalf);
    if (film.aovs.albedo) {
        add_channels(spec, {"albedo.R", "albedo.G", "albedo.B"}, OIIO::TypeHalf);
    }
    if (film.aovs.normal) add_channels(spec, {"N.X", "N.Y", "N.Z"}, OIIO::TypeHalf);
    if (film.aovs.position) add_channels(spec, {"P.X", "P.Y", "P.Z"}, OIIO::TypeFloat);
    if (film.aovs.depth) {
        add_channels(spec, {"Z"}, OIIO::TypeFloat);
        spec.z_channel = int(spec.channelnames.size()) - 1;
    }
    if (film.aovs.hit) add_channels(spec, {"hit"}, OIIO::TypeFloat);
    if (film.aovs.age) add_channels(spec, {"age"}, OIIO::TypeFloat);
    if (film.aovs.occluded) add_channels(spec, {"occluded"}, OIIO::TypeFloat);
    spec.nchannels = int(spec.channelnames.size());
    spec.alpha_channel = 3;
    // Half the time of the default level, for files a tenth larger (measured on the still life).
    spec.attribute("compression", "zip:2");
    spec.attribute("oiio:ColorSpace", "Linear");
    return spec;
}

// A half holds up to 65504; what is brighter would become infinite.
float within_half(float x) noexcept { return std::clamp(x, -65504.0f, 65504.0f); }

ExrPixels exr_pixels(const Film& film) {
    ExrPixels pixels{exr_spec(film), {}};
    const auto stride = std::size_t(pixels.spec.nchannels);
    pixels.values.resize(film.color.size() * stride);
    std::size_t first = 0;  // channel of the picture that is copied next
    const auto copy = [&](const auto& picture, int components, bool as_half) {
        for (std::size_t i = 0; i < picture.size(); ++i) {
            float* const to = pixels.values.data() + i * stride + first;
            for (int c = 0; c < components; ++c) {
                to[c] = as_half ? within_half(picture[i][c]) : picture[i][c];
            }
        }
        first += picture.empty() ? 0 : std::size_t(components);
    };
    copy(film.color, 4, true);
    copy(film.albedo, 3, true);
    copy(film.N, 3, false);
    copy(film.P, 3, false);
    for (const std::vector<float>* picture : {&film.depth, &film.hit, &film.age, &film.occluded}) {
        for (std::size_t i = 0; i < picture->size(); ++i) {
            pixels.values[i * stride + first] = (*picture)[i];
        }
        first += picture->empty() ? 0 : 1;
    }
    return pixels;
}

std::uint8_t to_byte(float x) noexcept {
    return std::uint8_t(std::lround(std::clamp(x, 0.0f, 1.0f) * 255.0f));
}

std::vector<std::uint8_t> png_pixels(const Film& film) {
    std::vector<std::uint8_t> bytes;
    bytes.reserve(film.color.size() * 4);
    for (const glm::vec4& pixel : film.color) {
        for (int c = 0; c < 3; ++c) {
            const float straight = pixel.a > 0.0f ? pixel[c] / pixel.a : 0.0f;
            bytes.push_back(to_byte(OIIO::linear_to_sRGB(std::clamp(straight, 0.0f, 1.0f))));
        }
        bytes.push_back(to_byte(pixel.a));
    }
    return bytes;
}

OIIO::ImageSpec png_spec(const Film& film) {
    OIIO::ImageSpec spec(film.width, film.height, 4, OIIO::TypeUInt8);
    spec.attribute("oiio:UnassociatedAlpha", 1);
    spec.attribute("oiio:ColorSpace", "sRGB");
    return spec;
}

/// Where a file keeps what it was rendered with.
constexpr const char* settings_key = "estara:settings";

OIIO::ImageSpec with_settings(OIIO::ImageSpec spec, const Film& film) {
    if (!film.settings.empty()) spec.attribute(settings_key, film.settings);
    return spec;
}

/// OpenImageIO's own words, one line, at most 200 characters.
std::string first_line(std::string text) {
    text.resize(std::min({text.find('\n'), text.size(), std::size_t(200)}));
    return text.empty() ? "the disk may be full" : text;
}

/// Encodes in memory: OpenImageIO does not notice that a PNG has been cut short on its way to the
/// disk.
void write_pixels(PendingFile& file, const std::string& path, OIIO::ImageSpec spec,
                  OIIO::TypeDesc type, const void* pixels) {
    const std::string& temporary = file.path();
    OIIO::Filesystem::IOVecOutput bytes;
    spec.attribute("Software", fmt::format("estara-render {}", version));
    const std::unique_ptr<OIIO::ImageOutput> output = OIIO::ImageOutput::create(temporary);
    if (!output) {
        throw Error(fmt::format("{}: cannot be written: {}", path, first_line(OIIO::geterror())),
                    ExitStatus::failed);
    }
    if (!output->set_ioproxy(&bytes) || !output->open(temporary, spec) ||
        !output->write_image(type, pixels) || !output->close()) {
        throw Error(fmt::format("{}: cannot be written: {}", path, first_line(output->geterror())),
                    ExitStatus::failed);
    }
    file.write({reinterpret_cast<const char*>(bytes.buffer().data()), bytes.buffer().size()});
}

}  // namespace

void write_image(const std::string& path, ImageFormat format, const Film& film) {
    PendingFile file(path);
    if (format == ImageFormat::exr) {
        const ExrPixels pixels = exr_pixels(film);
        write_pixels(file, path, with_settings(pixels.spec, film), OIIO::TypeFloat,
                     pixels.values.data());
    } else {
        const std::vector<std::uint8_t> bytes = png_pixels(film);
        write_pixels(file, path, with_settings(png_spec(film), film), OIIO::TypeUInt8,
                     bytes.data());
    }
    file.commit();
}

std::optional<std::string> image_settings(const std::string& path) {
    const std::unique_ptr<OIIO::ImageInput> input = OIIO::ImageInput::open(path);
    if (!input) {
        (void)OIIO::geterror();  // that it cannot be read is the answer
        return std::nullopt;
    }
    const std::string text = input->spec().get_string_attribute(settings_key);
    if (text.empty()) return std::nullopt;
    return text;
}

Film read_image(const std::string& path) {
    const std::unique_ptr<OIIO::ImageInput> input = OIIO::ImageInput::open(path);
    if (!input) {
        throw Error(fmt::format("{}: cannot be read: {}", path, first_line(OIIO::geterror())),
                    ExitStatus::failed);
    }
    const OIIO::ImageSpec& spec = input->spec();
    const auto channels = std::size_t(spec.nchannels);
    std::vector<float> values(std::size_t(spec.width) * std::size_t(spec.height) * channels);
    if (!input->read_image(0, 0, 0, spec.nchannels, OIIO::TypeFloat, values.data())) {
        throw Error(fmt::format("{}: cannot be read: {}", path, first_line(input->geterror())),
                    ExitStatus::failed);
    }
    const bool is_srgb = spec.get_string_attribute("oiio:ColorSpace") == "sRGB";
    Film film(spec.width, spec.height, {});
    for (std::size_t i = 0; i < film.color.size() && channels >= 4; ++i) {
        const float* const from = values.data() + i * channels;
        for (int c = 0; c < 3; ++c) {
            // OpenImageIO has associated alpha by itself, after the curve; so it is undone first.
            const float straight = is_srgb && from[3] > 0.0f ? from[c] / from[3] : from[c];
            film.color[i][c] = is_srgb ? OIIO::sRGB_to_linear(straight) * from[3] : from[c];
        }
        film.color[i].a = from[3];
    }
    return film;
}

}  // namespace estara
