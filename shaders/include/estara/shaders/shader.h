// What a shader is: two functions with one record between them.
//
//     Baked      bake(const SurfacePoint&) const noexcept;       where it is
//     glm::vec3  view(const Baked&, const Seen&) const noexcept;  how it looks from here
//
// The members of a shader are its parameters, the members of Baked its channels, and each is
// declared once, in params() and channels(). is_shader() checks at compile time that nothing else
// comes along: this is what makes the baked half reusable in every frame. A shader may also have
//
//     Domain  domain() const noexcept;              what decides its colour; default: Domain::point
//     bool    needs_uv() const noexcept;            whether without texture coordinates it is an
//                                                   error; default: if domain() is surface
//     float   octave(const SurfacePoint&, int k) const noexcept;  term k of SurfacePoint's
//                                                   octave_sum; an OctaveTerm is five of them
//     int     octaves(float filter_width) const noexcept;  their number; default:
//                                                   octaves_for(filter_width) (noise.h)
//     S       resolved(bool has_uv) const noexcept; settles parameters that depend on the mesh
//     bool    layered() const noexcept;             see BoundShader::layered(); default: false
//     bool    glossy() const noexcept;              see BoundShader::glossy(); default: true
//     float   highlight_cosine() const noexcept;    N.H below which a light alone shows nothing
//                                                   (lobes.h, highlight_edge()): taken as 0
//     bool    perturbs_normal() const noexcept;     whether its normal channel, the last one, is
//                                                   used with these parameters; default: true
#pragma once

#include <glm/glm.hpp>

#include <concepts>
#include <string_view>
#include <tuple>
#include <type_traits>

#include "estara/shaders/kernel.h"
#include "estara/shaders/registry.h"
#include "estara/shaders/seen.h"
#include "estara/shaders/surface_point.h"

namespace estara {

/// A parameter of shader S: where it is kept, what it may be and what it means.
template <class S, class T>
struct Param {
    std::string_view name;
    T S::*member;
    Part part;  ///< which half uses it
    Unit unit;
    float min, max;  ///< inclusive; of each component
    std::string_view help;
};

/// A channel of the record that bake() leaves for view(): a grid of the .vdb. A channel that is the
/// normal comes last, and reaches view() as Seen::N alone.
template <class B, class T>
struct Channel {
    std::string_view name;
    T B::*member;
    std::string_view help;
    ChannelKind kind = ChannelKind::value;
};

/// Whether S has sums over octaves, of one number or of five; is_shader() refuses an octave() of
/// another form.
template <class S>
concept HasFiveSums = requires(const S& shader, const SurfacePoint& x) {
    { shader.octave(x, 0) }
    noexcept->std::same_as<OctaveTerm>;
};
template <class S>
concept HasOctaves = HasFiveSums<S> || requires(const S& shader, const SurfacePoint& x) {
    { shader.octave(x, 0) }
    noexcept->std::same_as<float>;
};

/// Whether S says how many terms its sums have; is_shader() refuses an octaves() of another form.
template <class S>
concept HasOctaveCount = requires(const S& shader) {
    { shader.octaves(1.0f) }
    noexcept->std::same_as<int>;
};

/// Whether S says where the highlight of a light ends.
template <class S>
concept HasHighlight = requires(const S& shader) {
    { shader.highlight_cosine() }
    noexcept->std::same_as<float>;
};

namespace detail {

template <class S, class T>
constexpr std::size_t bytes_of(const Param<S, T>&) {
    static_assert(
        std::is_same_v<T, float> || std::is_same_v<T, int> || std::is_same_v<T, glm::vec3>,
        "a parameter is a float, an int or a vec3");
    return sizeof(T);
}
template <class B, class T>
constexpr std::size_t bytes_of(const Channel<B, T>&) {
    static_assert(std::is_same_v<T, float> || std::is_same_v<T, glm::vec3>,
                  "a channel is a float or a vec3");
    return sizeof(T);
}

template <class Tuple>
constexpr std::size_t bytes_declared(const Tuple& declared) {
    return std::apply([](const auto&... one) { return (std::size_t{0} + ... + bytes_of(one)); },
                      declared);
}

template <class B, class T>
constexpr bool kind_fits(const Channel<B, T>& channel, bool last) {
    if (channel.kind == ChannelKind::value) return true;
    return std::is_same_v<T, glm::vec3> && (last || channel.kind != ChannelKind::normal);
}

template <class Tuple>
constexpr bool kinds_fit(const Tuple& channels) {
    return std::apply(
        [](const auto&... one) {
            std::size_t left = sizeof...(one);
            return (true && ... && kind_fits(one, --left == 0));
        },
        channels);
}

}  // namespace detail

/// Refuses, with a sentence, a type that is not a shader. True for every shader.
template <class S>
consteval bool is_shader() {
    using Baked = typename S::Baked;
    static_assert(
        std::is_nothrow_invocable_r_v<Baked, decltype(&S::bake), const S&, const SurfacePoint&>,
        "bake() takes a SurfacePoint and nothing else; it is const and noexcept");
    static_assert(std::is_nothrow_invocable_r_v<glm::vec3, decltype(&S::view), const S&,
                                                const Baked&, const Seen&>,
                  "view() takes a Baked and a Seen and nothing else; it is const and noexcept");
    static_assert(std::is_trivially_copyable_v<S> && std::is_default_constructible_v<S>,
                  "a shader is a plain bag of parameters: it owns nothing");
    static_assert(sizeof(S) == detail::bytes_declared(S::params()),
                  "every member of a shader is one of its params(): nothing else comes along");
    static_assert(
        std::is_trivially_copyable_v<Baked> &&
            sizeof(Baked) == detail::bytes_declared(S::channels()),
        "every member of Baked is one of its channels(): what is not stored cannot be read back");
    static_assert(
        detail::kinds_fit(S::channels()),
        "a channel that is a normal or a direction is a vec3, and a normal is the last channel");
    static_assert(
        HasOctaves<S> || !requires { &S::octave; },
        "octave() takes a SurfacePoint and an int and returns a float or an OctaveTerm; it is "
        "const and noexcept");
    static_assert(
        HasOctaveCount<S> || !requires { &S::octaves; },
        "octaves() takes the filter width and returns an int; it is const and noexcept");
    return true;
}

template <class S>
Domain domain_of(const S& shader) noexcept {
    if constexpr (requires { shader.domain(); }) {
        return shader.domain();
    } else {
        return Domain::point;
    }
}

template <class S>
bool needs_uv(const S& shader) noexcept {
    if constexpr (requires { shader.needs_uv(); }) {
        return shader.needs_uv();
    } else {
        return domain_of(shader) == Domain::surface;
    }
}

template <class S>
bool layered(const S& shader) noexcept {
    if constexpr (requires { shader.layered(); }) {
        return shader.layered();
    } else {
        return false;
    }
}

template <class S>
bool glossy(const S& shader) noexcept {
    if constexpr (requires { shader.glossy(); }) {
        return shader.glossy();
    } else {
        return true;
    }
}

template <class S>
bool perturbs_normal(const S& shader) noexcept {
    if constexpr (requires { shader.perturbs_normal(); }) {
        return shader.perturbs_normal();
    } else {
        return true;
    }
}

}  // namespace estara
