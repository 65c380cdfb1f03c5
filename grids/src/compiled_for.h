// A function compiled for every instruction set, the widest that the machine has chosen at run
// time. No contraction and no reordering: the bits of the results are the same on all of them.
#pragma once

#include "estara/shaders/registry.h"

namespace estara {

// Functions with a target of their own in one translation unit: shaders/src/bake_all.h says why,
// and why not without optimisation.
#if defined(__x86_64__) && defined(__OPTIMIZE__) && !defined(__clang__)
#define ESTARA_DISPATCH 1
template <auto kernel, class... Args>
[[gnu::flatten, gnu::target("arch=x86-64-v2")]] void run_sse42(Args... args) noexcept {
    kernel(args...);
}
template <auto kernel, class... Args>
[[gnu::flatten, gnu::target("arch=x86-64-v3")]] void run_avx2(Args... args) noexcept {
    kernel(args...);
}
template <auto kernel, class... Args>
[[gnu::flatten, gnu::target("arch=x86-64-v4,prefer-vector-width=512")]] void run_avx512(
    Args... args) noexcept {
    kernel(args...);
}
#endif

template <class Function>
struct CompiledFor;

template <class... Args>
struct CompiledFor<void (*)(Args...) noexcept> {
    using Function = void (*)(Args...) noexcept;

    /// The kernel for this machine's widest instruction set, but none wider than limit.
    template <Function kernel>
    static Function choose([[maybe_unused]] InstructionSet limit) noexcept {
#ifdef ESTARA_DISPATCH
        if (limit >= InstructionSet::avx512 && __builtin_cpu_supports("x86-64-v4"))
            return run_avx512<kernel, Args...>;
        if (limit >= InstructionSet::avx2 && __builtin_cpu_supports("x86-64-v3"))
            return run_avx2<kernel, Args...>;
        if (limit >= InstructionSet::sse42 && __builtin_cpu_supports("x86-64-v2"))
            return run_sse42<kernel, Args...>;
#endif
        return kernel;
    }
};

/// compiled_for<kernel>(limit): see CompiledFor.
template <auto kernel>
auto compiled_for(InstructionSet limit) noexcept {
    return CompiledFor<decltype(kernel)>::template choose<kernel>(limit);
}

}  // namespace estara
