// The exported page of models and a measurement.
#pragma once
#include "app/load.h"
#include "extras/render/page.h"

namespace SRBF_NAMESPACE {

/// The page material of a subject: its plots, and for a model also its picture and parameters.
PageMaterial shown(const LoadedFile& subject);
/// The page of at least one model. With a measurement (of a BRDF) it also has the errors against it. It refers to
/// the subjects.
Page page_of(const std::vector<LoadedFile>& models, const LoadedFile* measured);

}  // namespace
