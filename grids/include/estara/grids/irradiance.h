// How baked light lies in a TextureGrid (README.md, "Irradiance").
#pragma once

namespace estara {

/// Stands where a shader's name stands.
inline constexpr const char* irradiance_shader = "irradiance";

/// Its channels: 3 floats, irradiance / pi of all lights on the front of the surface, and 1 float,
/// above 0 where it is not to be trusted (a shadow's edge) and rays must tell.
inline constexpr const char* irradiance_channel = "irradiance";
inline constexpr const char* irradiance_mask_channel = "irradiance_mask";

/// A looked-up mask above this means rays. Not 0: the mask of a cell that is not to be trusted is 1
/// all over it, and falls to 0 within the cells beside it.
inline constexpr float irradiance_mask_limit = 1.0f / 16.0f;

}  // namespace estara
