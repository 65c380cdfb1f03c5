// Builds a scene and writes it as a .glb file.
#pragma once

#include <glm/glm.hpp>
#include <glm/gtc/quaternion.hpp>

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "estara/scenes/deformation.h"
#include "estara/scenes/mesh.h"

namespace estara::examples {

/// A material that wears a shader: goes into glTF's "extras".
struct Material {
    std::string name;
    std::string shader;
    std::vector<std::pair<std::string, std::vector<double>>> params;  ///< 1 number or 3 each
    glm::dvec3 base_color{0.5};  ///< what programs show that do not know the shader
};

/// Where something is, relative to its parent.
struct Placement {
    glm::vec3 translation{0.0f};
    glm::quat rotation{1.0f, 0.0f, 0.0f, 0.0f};
    float scale = 1.0f;
    int parent = -1;  ///< node; -1: the world
};

/// A light of KHR_lights_punctual that shines along its node's -z.
struct Lamp {
    std::string name;
    std::string type;  ///< "directional", "point" or "spot"
    glm::dvec3 color{1.0};
    double intensity = 1.0;                       ///< lux (directional) or candela
    double inner_cone = 0.0, outer_cone = 0.785;  ///< radians from the axis, spots only
    bool shadow = true;
};

/// The light that gives irradiance / pi = `Cl` on a surface that faces it.
/// Directional lights, lux; glTF's light is photometric, at 683 lumens a watt.
double lux_for(double Cl);
/// Point and spot lights at a distance, candela.
double candela_for(double Cl, double distance);

/// The rotation that turns -z towards `forward` and y as far up as that allows.
/// @param forward  not zero, not vertical
glm::quat looking_along(const glm::vec3& forward);

class GlbBuilder {
public:
    GlbBuilder();
    ~GlbBuilder();

    /// Each returns the index of a new node, mesh or material.
    int add_node(const std::string& name, const Placement& placement);
    int add_material(const Material& material);
    /// @param bends  influences of four a vertex, or none
    int add_mesh(const std::string& name, const Mesh& mesh, int material,
                 const Deformation& bends = {});
    int add_object(const std::string& name, int mesh, const Placement& placement);
    int add_camera(const std::string& name, double yfov, const Placement& placement);
    int add_lamp(const Lamp& lamp, const Placement& placement);

    /// Lets joints (nodes) carry a node's mesh. @param rest  by joint: where it is at rest
    void add_skin(int node, const std::vector<int>& joints, const std::vector<glm::mat4>& rest);

    /// Linear key frames of a node. @param times  seconds, ascending; as many as values
    void animate_rotation(int node, const std::vector<float>& times,
                          const std::vector<glm::quat>& values);
    void animate_translation(int node, const std::vector<float>& times,
                             const std::vector<glm::vec3>& values);
    /// @param values  of all morph targets at the first time, then at the second, ...
    void animate_weights(int node, const std::vector<float>& times,
                         const std::vector<float>& values);

    /// RSL's ambient light.
    void set_ambient(const glm::dvec3& ambient);

    /// Puts the whole file in place, or leaves what was there. Error (failed) if the disk is full.
    void write(const std::string& path) const;

private:
    struct Impl;
    std::unique_ptr<Impl> m_impl;
};

}  // namespace estara::examples
