// The exported page of models and a measurement.
#pragma once
#include <string>
#include <vector>

#include "app/load.h"
#include "extras/render/page.h"

namespace srbf {

/// A subject with its plots, and a model with its picture and its parameters.
PageMaterial shown(const Subject& subject);
/// The page of at least one model; with a measurement beside them, of one side, the errors against it too. It refers to
/// the subjects.
Page page_of(const std::vector<Subject>& models, const Subject* measured);

}  // namespace srbf
