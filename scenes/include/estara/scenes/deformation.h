// Meshes that bend: glTF's skins and morph targets. Patterns stay in the rest pose, which is the
// mesh as the file has it: only what is traced and lit bends.
#pragma once

#include <glm/glm.hpp>

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "estara/scenes/mesh.h"

namespace estara {

/// Which joints of a skin move each vertex of a mesh.
struct Influences {
    static constexpr int most = 8;
    int count = 0;                     ///< of each vertex, [0, most]; 0: no joint moves the mesh
    std::vector<std::uint16_t> joint;  ///< `count` a vertex: indices into Skin::joints
    std::vector<float> weight;         ///< likewise, >= 0; those of a vertex sum to 1
};

/// What a weight of 1 adds to the vertices, in the rest pose.
struct MorphTarget {
    std::vector<glm::vec3> P;
    std::vector<glm::vec3> N;  ///< empty: normals stay
};

/// How a mesh can bend. Arrays go by vertex of the mesh.
struct Deformation {
    std::vector<MorphTarget> targets;
    Influences influences;
};

/// Joints that carry meshes.
struct Skin {
    std::string name;
    std::vector<int> joints;                 ///< indices into Scene::nodes
    std::vector<glm::mat4> joint_from_rest;  ///< by joint: glTF's inverse bind matrices
};

/// A mesh as it is bent at one time. Vertices are given from a point nearby (the matrix of its
/// place, Pose::world_from_instance, moves them into the world and does nothing else), so that
/// distance from the origin costs no digits.
struct BentMesh {
    std::vector<glm::vec3> P;
    std::vector<glm::vec3> N;    ///< unit; empty if the mesh is flat
    std::vector<glm::vec3> Ng;   ///< by triangle, unit, on the side that it has at rest
    std::vector<float> stretch;  ///< by triangle: root of its area over that at rest, > 0
};

/// A bent mesh and the point that its vertices are given from, world.
struct Bent {
    std::shared_ptr<const BentMesh> mesh;  ///< null: not all of it is finite
    glm::dvec3 anchor{0.0};
};

/// Bends a mesh: morph targets first, then joints, computed in double (glTF 2.0, 3.7.2.2
/// and 3.7.3). Normals are turned by the inverse transpose of what moves their vertex. Parallel;
/// the same bits for any number of threads.
/// @param weights            of the morph targets; may be fewer than there are
/// @param world_from_rest    of what no joint moves
/// @param world_from_joints  by joint, from the rest pose; empty: no joint moves the mesh
Bent bend(const Mesh& mesh, const Deformation& how, std::span<const float> weights,
          const glm::dmat4& world_from_rest, std::span<const glm::dmat4> world_from_joints);

/// A vector of the rest pose at a point of a bent mesh, carried along with the surface there.
///
/// A frame of the triangle's edges, made perpendicular to the shading normal, and that normal takes
/// it from rest to bent. What is perpendicular to the surface keeps its length.
class CarriedFrame {
public:
    /// @param N_rest, N_bent  shading normals there, unit
    CarriedFrame(const Mesh& mesh, const BentMesh& bent, std::uint32_t triangle,
                 const glm::vec3& N_rest, const glm::vec3& N_bent) noexcept;
    /// A direction in the surface; not of unit length.
    glm::vec3 direction(const glm::vec3& rest) const noexcept;
    /// A normal (by the inverse transpose), unit; N_bent for N_rest, and where the triangle is
    /// degenerate.
    glm::vec3 normal(const glm::vec3& rest) const noexcept;

private:
    glm::dmat3 m_rest, m_bent;  ///< columns: two edges and the normal
    glm::vec3 m_N_bent;
};

}  // namespace estara
