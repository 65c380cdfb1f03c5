// The bridge between a shader's type and BoundShader, behind which the programs see it.
#pragma once

#include <glm/glm.hpp>

#include <cstddef>
#include <tuple>
#include <vector>

#include "estara/shaders/registry.h"
#include "estara/shaders/shader.h"

namespace estara::detail {

/// bake() and view() over a batch, as BoundShader has them. Defined in loops.h and compiled once
/// per shader (bound.cpp.in), because that is slow.
template <class S>
struct Loops {
    static void bake(const S& shader, const SurfaceBatch& in, int first, int last, float* planes,
                     InstructionSet limit) noexcept;
    static void view(const S& shader, const float* planes, const SeenBatch& seen, int first,
                     int last, bool lit, float* Ci, InstructionSet limit) noexcept;
};

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
                 {c.name, int(sizeof(record.*c.member) / sizeof(float)), c.help, c.kind}),
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
        : m_info(info), m_limit(limit) {
        std::size_t i = 0;
        std::apply([&](const auto&... p) { (assign(m_shader.*p.member, values[i++]), ...); },
                   S::params());
        if constexpr (requires { m_shader.resolved(has_uv); }) m_shader = m_shader.resolved(has_uv);
        if (!perturbs_normal(m_shader) && m_info.channels.back().kind == ChannelKind::normal) {
            m_info.channels.pop_back();
            m_info.baked_floats -= 3;
        }
    }

    const ShaderInfo& info() const noexcept override { return m_info; }
    Domain domain() const noexcept override { return domain_of(m_shader); }
    bool needs_uv() const noexcept override { return estara::needs_uv(m_shader); }
    bool layered() const noexcept override { return estara::layered(m_shader); }
    bool glossy() const noexcept override { return estara::glossy(m_shader); }

    std::vector<glm::vec3> values() const override {
        std::vector<glm::vec3> v;
        std::apply([&](const auto&... p) { (v.push_back(as_vec3(m_shader.*p.member)), ...); },
                   S::params());
        return v;
    }

    void bake(const SurfaceBatch& in, int first, int last, float* planes) const noexcept override {
        Loops<S>::bake(m_shader, in, first, last, planes, m_limit);
    }

    void view(const float* planes, const SeenBatch& seen, int first, int last, bool lit,
              float* Ci) const noexcept override {
        Loops<S>::view(m_shader, planes, seen, first, last, lit, Ci, m_limit);
    }

private:
    ShaderInfo m_info;
    InstructionSet m_limit;
    S m_shader;
};

}  // namespace estara::detail
