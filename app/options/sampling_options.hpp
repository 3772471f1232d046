// How samples are drawn, as the command line says; shared by the subcommands that trace paths.
#pragma once

#include <CLI/CLI.hpp>
#include <string>

#include "render/backend.hpp"

namespace kiloband {

struct SamplingOptions {
  std::string wavelengths = "shared", sampler = "sobol", rough_dispersion = "mis";
  uint64_t seed = 0;

  void add_to(CLI::App& command);
  SamplingSettings settings(uint32_t replicates) const;
};

}  // namespace kiloband
