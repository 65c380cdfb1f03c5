// A finished picture in memory.
#pragma once

#include <glm/glm.hpp>

#include <cstddef>
#include <string>
#include <vector>

namespace estara {

/// Which pictures are wanted beside the colour.
struct Aovs {
    bool albedo =
        false;  ///< the baked channel "color", linear Rec. 709; 0 for a shader without one
    bool normal = false;    ///< "N": shading normal turned to the eye, world space
    bool position = false;  ///< "P": world space
    bool depth = false;     ///< "depth": distance to the eye, world units
    bool hit = false;       ///< share of the samples that were recalled from the cache
    bool age = false;       ///< frames since they were found, new ones 0
    bool occluded = false;  ///< share of the samples whose recalled point was hidden

    bool any() const noexcept {
        return albedo || normal || position || depth || hit || age || occluded;
    }
    bool operator==(const Aovs&) const = default;
};

/// Switches on the picture of that name: albedo, N, P, depth, hit, age or occluded. Error for any
/// other, listing them.
void add_aov(Aovs& aovs, const std::string& name);

/// Row by row from the upper left pixel. Where nothing was hit everything is 0.
struct Film {
    /// All black. AOVs that are not wanted stay empty.
    Film(int width, int height, const Aovs& aovs);

    int width, height;
    Aovs aovs;
    std::vector<glm::vec4>
        color;  ///< linear Rec. 709, associated alpha = share of the pixel covered
    std::vector<glm::vec3> albedo, N, P;  ///< mean over the samples that hit something
    std::vector<float> depth;             ///< likewise
    std::vector<float> hit, age, occluded;
    std::string settings;  ///< what it was rendered with, kept in its files (settings.h)

    /// Of memory.
    std::size_t bytes() const noexcept {
        return color.size() * sizeof color[0] +
               (albedo.size() + N.size() + P.size()) * sizeof(glm::vec3) +
               (depth.size() + hit.size() + age.size() + occluded.size()) * sizeof(float);
    }

    std::size_t index(int x, int y) const noexcept {
        return std::size_t(y) * std::size_t(width) + std::size_t(x);
    }
};

}  // namespace estara
