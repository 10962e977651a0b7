#include "extras/render/environment.h"
#include "extras/render/page.h"

namespace SRBF_NAMESPACE {

Image page_environment() { return halved(load_environment(std::string(k_built_in_environment))->texels()); }

}  // namespace
