// How building blocks and bake() functions are marked so that the loop over a batch becomes wide.
#pragma once

// g++ 12 gives up on [[gnu::flatten]] once functions nest deeply, and one call left in the loop
// keeps the whole loop scalar: so every function that bake() uses says itself that it is inlined.
#define ESTARA_KERNEL [[gnu::always_inline]] inline
