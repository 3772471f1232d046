// Sums of samples in a film that devices of several kinds add to.
#pragma once

#include <atomic>
#include <functional>
#include <vector>

#include "render/backend.hpp"

namespace kiloband {

/// Of films to which backends add that have different rules of their own: every delivery adds its mean times its
/// samples to a double.
inline constexpr SumRule kStagedRule{SumRule::Kind::kFolded, 0, 1, 1};

/// Bytes that a delivery of a block takes meanwhile, at most.
std::size_t staged_bytes_of_block(std::size_t channels);

/// Backend::render() of a film with sums of kStagedRule: by way of films with the backend's own rule, which have at most twice the
/// pixels of their blocks, and from which these are added once all of them have been rendered. Where the backend throws, blocks of films
/// before were.
/// rule  backend.sum_rule()
void render_staged(Backend& backend, const SumRule& rule, SpectralFilm& film, const SampleRange& range,
                   const std::vector<uint32_t>& blocks, const std::atomic<bool>& stop,
                   const std::function<void(uint64_t)>& progress);

}  // namespace kiloband
