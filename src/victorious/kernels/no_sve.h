// Private to kernels/, included before Highway: no code for SVE, whose vectors cannot be elements of arrays and
// members. Such processors run the NEON code.
#pragma once

#define HWY_DISABLED_TARGETS (HWY_SVE | HWY_SVE2 | HWY_SVE_256 | HWY_SVE2_128)
