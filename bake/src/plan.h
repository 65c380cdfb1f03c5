// What is to be baked: which objects, in which shader, with which voxels.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "estara/bake/bake.h"
#include "estara/bake/options.h"

namespace estara::bake {

/// An object to bake, with the shader it wears for this bake.
struct Job {
    const Object* object = nullptr;
    BoundShaderPtr shader;
    std::optional<double> voxel_size;  ///< none: --max-error will find it
    BakeEstimate estimate;             ///< of voxel_size
};

/// The jobs of a run. A voxel size that the user gave and that does not fit into --max-memory is an
/// Error with one that does; one that the camera path asked for is raised until it fits, with a
/// warning.
/// @param sizes  by object, what automatic_voxel_sizes() says; empty: not known yet
std::vector<Job> plan(const Scene& scene, const Options& options,
                      const std::function<void(const std::string&)>& message,
                      std::vector<double> sizes = {});

/// The voxel sizes that the camera path asks for, by object.
std::vector<double> sizes_from_camera(const Scene& scene, const Options& options);

/// Runs work and puts the job's object before what is wrong with it.
template <class Work>
auto naming(const Job& job, Work work) {
    try {
        return work();
    } catch (const Error& error) {
        throw Error("object \"" + job.object->name + "\": " + error.what(), error.status());
    }
}

}  // namespace estara::bake
