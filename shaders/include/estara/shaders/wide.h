// Loops over points, compiled once for every instruction set; the machine's widest one is run.
#pragma once

namespace estara {

/// What wide() compiles for. Results have the same bits on all of them (-ffp-contract=off).
enum class InstructionSet { baseline, sse42, avx2, avx512 };

/// How the lambda that is given to wide() is marked, after its parameters: else it stays a call.
#define ESTARA_LOOP __attribute__((always_inline))

namespace detail {

// The copy's address goes nowhere, so that no store in the loop can change what was captured.
template <class Loop>
[[gnu::flatten, gnu::noinline]] void run_baseline(const Loop& given) noexcept {
    const Loop loop = given;
    loop();
}

// Functions with a target of their own, in one translation unit, rather than a file compiled once
// per instruction set: an inline function that the linker takes from the wrong copy would be an
// illegal instruction on an older machine.
// Without optimisation there is nothing to gain and much to compile.
#if defined(__x86_64__) && defined(__OPTIMIZE__) && !defined(__clang__)
#define ESTARA_DISPATCH 1
template <class Loop>
[[gnu::flatten, gnu::noinline, gnu::target("arch=x86-64-v2")]] void run_sse42(
    const Loop& given) noexcept {
    const Loop loop = given;
    loop();
}
template <class Loop>
[[gnu::flatten, gnu::noinline, gnu::target("arch=x86-64-v3")]] void run_avx2(
    const Loop& given) noexcept {
    const Loop loop = given;
    loop();
}
template <class Loop>
[[gnu::flatten, gnu::noinline, gnu::target("arch=x86-64-v4,prefer-vector-width=512")]] void
run_avx512(const Loop& given) noexcept {
    const Loop loop = given;
    loop();
}
#endif

inline InstructionSet widest() noexcept {
#ifdef ESTARA_DISPATCH
    if (__builtin_cpu_supports("x86-64-v4")) return InstructionSet::avx512;
    if (__builtin_cpu_supports("x86-64-v3")) return InstructionSet::avx2;
    if (__builtin_cpu_supports("x86-64-v2")) return InstructionSet::sse42;
#endif
    return InstructionSet::baseline;
}

}  // namespace detail

/// The widest instruction set of this machine.
inline InstructionSet instruction_set() noexcept {
    static const InstructionSet set = detail::widest();
    return set;
}

/// Calls loop() compiled for the widest instruction set of the machine, but none wider than
/// `limit`.
///
/// The lambda captures by value (a captured reference could be what a store in the loop changes)
/// and is marked ESTARA_LOOP; what it calls is marked ESTARA_KERNEL. Arrays that are members of one
/// struct are known to be apart; a loop over others needs `#pragma GCC ivdep`.
template <class Loop>
void wide(const Loop& loop, [[maybe_unused]] InstructionSet limit = InstructionSet::avx512) {
#ifdef ESTARA_DISPATCH
    const InstructionSet set = instruction_set();
    switch (set < limit ? set : limit) {
        case InstructionSet::avx512:
            return detail::run_avx512(loop);
        case InstructionSet::avx2:
            return detail::run_avx2(loop);
        case InstructionSet::sse42:
            return detail::run_sse42(loop);
        case InstructionSet::baseline:
            break;
    }
#endif
    detail::run_baseline(loop);
}

}  // namespace estara
