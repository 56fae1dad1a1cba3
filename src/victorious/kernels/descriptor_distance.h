// kernels/, squared distances between one descriptor and some others, each at a place of its own: the second pass of a
// proposal search (search/match/upright_matcher.h), behind short_nearest.h. For all pairs of two sets see nearest.h.
//
// descriptor_distance_ref.cc is the reference; descriptor_distance_simd.cc (Highway, every instruction set) returns
// identical bits. C++20.
#pragma once

#include <cstdint>
#include <span>

namespace victorious::kernels {

/// out[i] = |query - others[i]|^2.
/// @param query   kDescriptorBytes bytes
/// @param others  of descriptors, kDescriptorBytes bytes each
/// @param out     as many
void ComputeDescriptorDistances(const std::uint8_t* query, std::span<const std::uint8_t* const> others,
                                std::span<std::uint32_t> out);

/// The definition: the same, one pair and one byte after the other.
void ComputeDescriptorDistancesRef(const std::uint8_t* query, std::span<const std::uint8_t* const> others,
                                   std::span<std::uint32_t> out);

}  // namespace victorious::kernels
