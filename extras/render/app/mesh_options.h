// Options for the mesh of pictures.
#pragma once
#include "app/options.h"

namespace SRBF_NAMESPACE {

/// Options for the mesh of pictures and its upward axis.
std::vector<Option> add_mesh_options(const Subcommand& sub, std::string& mesh, std::string& up);
/// The option for the upward axis alone.
Option add_up_option(const Subcommand& sub, std::string& up, const std::string& about);

}  // namespace
