// What a program may know about the shaders: their names, parameters and channels, and a shader
// with its parameters bound. The only header of this folder that the other folders need, besides
// the three of the contract.
#pragma once

#include <glm/glm.hpp>

#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "estara/shaders/batch.h"
#include "estara/shaders/wide.h"

namespace estara {

enum class Unit { none, per_length, length, color };

/// Which half of a shader a parameter belongs to. One that only view() uses may change without a
/// new bake (tested for every shader).
enum class Part { bake, view };
enum class ValueType { number, integer, color };

/// How a unit is written in help texts: "", "1/length", "length", "linear Rec. 709".
std::string_view to_string(Unit unit) noexcept;

/// The shortest text that reads back as the same float.
std::string to_string(float value);
/// Likewise, "0.3,0.12,0.03".
std::string to_string(const glm::vec3& value);

/// What decides a shader's colour.
enum class Domain {
    point,    ///< P alone: it may be evaluated anywhere in space, so at voxel centres
    surface,  ///< N, uv or dPdu too: it exists on the surface only
};

struct ParamInfo {
    std::string_view name;
    ValueType type;
    glm::vec3 default_value;  ///< numbers and integers use x
    float min, max;           ///< inclusive; of every component for a colour
    Unit unit;
    Part part;
    std::string_view help;
    int components() const noexcept { return type == ValueType::color ? 3 : 1; }
};

/// What a channel is to the renderer.
enum class ChannelKind {
    value,      ///< a number or a colour, given to view() as it is
    normal,     ///< unit shading normal, object space, in place of the mesh's: view() sees it as
                ///< Seen::N, and E is the light on it
    direction,  ///< unit vector along the surface, object space; given to view() in world space
};

struct ChannelInfo {
    std::string_view name;  ///< also the name of the grid in the .vdb
    int components;         ///< 1 or 3
    std::string_view help;
    ChannelKind kind;
};

struct ShaderInfo {
    std::string_view name;
    std::string_view summary;
    std::vector<ParamInfo> params;
    std::vector<ChannelInfo> channels;  ///< in the order of the floats of a baked record
    int baked_floats;                   ///< sum of the channels' components
};

/// A parameter as the user gave it.
struct Setting {
    std::string name;
    std::vector<float> value;  ///< 1 number, or 3 for a colour
};

/// Something wrong with a user's setting, as data: the caller knows where it was written and makes
/// the message ("shader 'wood' has no parameter 'ringscael'; did you mean ...").
struct Problem {
    std::string setting;  ///< the name the user wrote
    std::string what;     ///< "shader 'wood' has no parameter 'ringscael'"
    std::string
        hint;  ///< "did you mean 'ringscale'? it has: ringscale, lightwood, ..."; may be empty
};

/// A shader with its parameters, type-erased. Immutable; any thread may use one at any time.
class BoundShader {
public:
    virtual ~BoundShader() = default;

    /// Of the shader with these parameters: without its normal channel if they do not perturb it.
    virtual const ShaderInfo& info() const noexcept = 0;
    virtual Domain domain() const noexcept = 0;
    /// Whether the mesh must have texture coordinates.
    virtual bool needs_uv() const noexcept = 0;
    /// Whether it is more than a colour of the surface point with a highlight: then it has no place
    /// in a grid, and its record is kept in the renderer's cache.
    virtual bool layered() const noexcept = 0;

    /// Whether view() makes anything of the lights by themselves, besides E.
    virtual bool glossy() const noexcept = 0;

    /// Value of every parameter, in the order of info().params.
    virtual std::vector<glm::vec3> values() const = 0;

    /// The view-independent part of points [first, last) of a batch: float k (of
    /// info().baked_floats) of point i becomes planes[k * SurfaceBatch::capacity + i].
    /// Bit-identical whatever the batch a point is in and whatever instruction set the machine has.
    virtual void bake(const SurfaceBatch& in, int first, int last,
                      float* planes) const noexcept = 0;
    /// Of all its points.
    void bake(const SurfaceBatch& in, float* planes) const noexcept {
        bake(in, 0, in.size, planes);
    }

    /// The view-dependent part of points [first, last) of planes as bake() lays them out, but with
    /// ChannelKind::direction in world space: their outgoing colour, linear Rec. 709. The whole of
    /// it is a sum: what E, A and the surface itself make, and what each light makes alone.
    /// @param lit  the batch's light alone, E, A and glow count as 0; or those, and no light
    /// @param Ci   three planes of SeenBatch::capacity floats
    virtual void view(const float* planes, const SeenBatch& seen, int first, int last, bool lit,
                      float* Ci) const noexcept = 0;
};

using BoundShaderPtr = std::shared_ptr<const BoundShader>;

/// All shaders, in the order of library/all.h.
std::span<const ShaderInfo> all_shaders();

/// The shader of that name, or nullptr.
const ShaderInfo* find_shader(std::string_view name);

/// The word of `known` nearest to `word` (edit distance at most a third of it, or
/// one letter of a short one), or "".
std::string_view nearest_word(std::string_view word, std::span<const std::string_view> known);

/// Names joined by ", ".
std::string shader_names();

struct BindResult {
    BoundShaderPtr shader;          ///< null if there are problems
    std::vector<Problem> problems;  ///< all of them, not just the first
};

/// Gives a shader its parameters: the defaults, overridden by settings.
/// @param name    must exist: check with find_shader() first (an unknown one is a Problem too)
/// @param has_uv  whether the mesh has texture coordinates: cobblestone chooses its variant by it
/// @param limit   bake() and view() use the widest instruction set of the machine, but none wider
/// than this
BindResult bind_shader(std::string_view name, std::span<const Setting> settings, bool has_uv,
                       InstructionSet limit = InstructionSet::avx512);

/// "ringscale=10 lightwood=0.3,0.12,0.03 ..." - every parameter, in order, shortest exact floats.
std::string describe_values(const BoundShader& shader);

/// Two shaders that bake alike have the same digest: 16 hex digits over name, version and every
/// parameter of Part::bake.
std::string shader_digest(const BoundShader& shader);

}  // namespace estara
