// The bridge between a shader's type and BoundShader, behind which the programs see it.
#pragma once

#include <glm/glm.hpp>

#include <cstddef>
#include <span>
#include <tuple>
#include <vector>

#include "estara/shaders/registry.h"
#include "estara/shaders/shader.h"

namespace estara::detail {

template <class S>
using BakeFunction = void (*)(const S&, const SurfaceBatch&, float*) noexcept;

/// The widest version of bake over a batch that this machine runs, but none wider than `limit`.
/// Defined in bake_all.h and compiled once per shader (bound.cpp.in), because it is slow to
/// compile.
template <class S>
BakeFunction<S> bake_function(InstructionSet limit) noexcept;

/// Reads a record from column i of planes.
template <class S, std::size_t channel = 0, int plane = 0>
void load(typename S::Baked& baked, const float* planes, std::size_t i) noexcept {
    constexpr auto channels = S::channels();
    if constexpr (channel < std::tuple_size_v<decltype(channels)>) {
        auto& value = baked.*std::get<channel>(channels).member;
        const float* const column = planes + plane * SurfaceBatch::capacity + i;
        if constexpr (std::is_same_v<decltype(value), float&>) {
            value = column[0];
            load<S, channel + 1, plane + 1>(baked, planes, i);
        } else {
            value = {column[0], column[SurfaceBatch::capacity], column[2 * SurfaceBatch::capacity]};
            load<S, channel + 1, plane + 3>(baked, planes, i);
        }
    }
}

inline glm::vec3 as_vec3(float v) { return {v, 0.0f, 0.0f}; }
inline glm::vec3 as_vec3(int v) { return {float(v), 0.0f, 0.0f}; }
inline glm::vec3 as_vec3(const glm::vec3& v) { return v; }

inline void assign(float& member, const glm::vec3& v) { member = v.x; }
inline void assign(int& member, const glm::vec3& v) { member = int(v.x); }
inline void assign(glm::vec3& member, const glm::vec3& v) { member = v; }

template <class T>
constexpr ValueType type_of() {
    if constexpr (std::is_same_v<T, float>)
        return ValueType::number;
    else if constexpr (std::is_same_v<T, int>)
        return ValueType::integer;
    else
        return ValueType::color;
}

template <class S>
ShaderInfo make_info() {
    static_assert(is_shader<S>());
    ShaderInfo info{S::name, S::summary, {}, {}, int(sizeof(typename S::Baked) / sizeof(float))};
    const S defaults{};
    std::apply(
        [&](const auto&... p) {
            (info.params.push_back({p.name, type_of<std::decay_t<decltype(defaults.*p.member)>>(),
                                    as_vec3(defaults.*p.member), p.min, p.max, p.unit, p.part,
                                    p.help}),
             ...);
        },
        S::params());
    const typename S::Baked record{};
    std::apply(
        [&](const auto&... c) {
            (info.channels.push_back(
                 {c.name, int(sizeof(record.*c.member) / sizeof(float)), c.help}),
             ...);
        },
        S::channels());
    return info;
}

template <class S>
class Bound final : public BoundShader {
public:
    Bound(const ShaderInfo& info, const std::vector<glm::vec3>& values, bool has_uv,
          InstructionSet limit)
        : m_info(info), m_bake(bake_function<S>(limit)) {
        std::size_t i = 0;
        std::apply([&](const auto&... p) { (assign(m_shader.*p.member, values[i++]), ...); },
                   S::params());
        if constexpr (requires { m_shader.resolved(has_uv); }) m_shader = m_shader.resolved(has_uv);
    }

    const ShaderInfo& info() const noexcept override { return m_info; }
    Domain domain() const noexcept override { return domain_of(m_shader); }

    std::vector<glm::vec3> values() const override {
        std::vector<glm::vec3> v;
        std::apply([&](const auto&... p) { (v.push_back(as_vec3(m_shader.*p.member)), ...); },
                   S::params());
        return v;
    }

    void bake(const SurfaceBatch& in, float* planes) const noexcept override {
        m_bake(m_shader, in, planes);
    }

    void view(const float* planes, std::span<const Seen> seen,
              glm::vec3* Ci) const noexcept override {
        typename S::Baked baked;
        for (std::size_t i = 0; i < seen.size(); ++i) {
            load<S>(baked, planes, i);
            Ci[i] = m_shader.view(baked, seen[i]);
        }
    }

private:
    const ShaderInfo& m_info;
    BakeFunction<S> m_bake;
    S m_shader;
};

}  // namespace estara::detail
