// Where in a pixel the samples lie.
#pragma once

#include <glm/glm.hpp>

#include <cstdint>
#include <vector>

namespace estara {

/// Positions inside a pixel, in pixels, [0, 1)^2: the same in every pixel and every frame, so that
/// nothing flickers that stands still.
///
/// One sample is the pixel's centre. More are a Hammersley set (x = (i + 1/2) / n, y = the radical
/// inverse of i in base 2, moved to be centred), shifted around the pixel's edges by the seed.
///
/// @param spp   samples a pixel, >= 1
/// @param seed  0: not shifted; other seeds give other shifts (never of a single sample)
std::vector<glm::vec2> sample_pattern(int spp, std::uint32_t seed);

}  // namespace estara
