#include "estara/render/film.h"

#include <fmt/format.h>

#include "estara/scenes/error.h"

namespace estara {

void add_aov(Aovs& aovs, const std::string& name) {
    if (name == "albedo") {
        aovs.albedo = true;
    } else if (name == "N") {
        aovs.normal = true;
    } else if (name == "P") {
        aovs.position = true;
    } else if (name == "depth") {
        aovs.depth = true;
    } else if (name == "hit") {
        aovs.hit = true;
    } else if (name == "age") {
        aovs.age = true;
    } else if (name == "occluded") {
        aovs.occluded = true;
    } else {
        throw Error(fmt::format(
            "--aov: no '{}'; there are: albedo, N, P, depth, hit, age, occluded", name));
    }
}

Film::Film(int width_, int height_, const Aovs& aovs_)
    : width(width_), height(height_), aovs(aovs_) {
    const std::size_t pixels = std::size_t(width) * std::size_t(height);
    color.assign(pixels, glm::vec4(0.0f));
    if (aovs.albedo) albedo.assign(pixels, glm::vec3(0.0f));
    if (aovs.normal) N.assign(pixels, glm::vec3(0.0f));
    if (aovs.position) P.assign(pixels, glm::vec3(0.0f));
    if (aovs.depth) depth.assign(pixels, 0.0f);
    if (aovs.hit) hit.assign(pixels, 0.0f);
    if (aovs.age) age.assign(pixels, 0.0f);
    if (aovs.occluded) occluded.assign(pixels, 0.0f);
}

}  // namespace estara
