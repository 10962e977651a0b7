// All kinds of models.
#pragma once
#include "models/bsdf/bsdf_file.h"
#include "models/ggx/ggx_file.h"
#include "models/openpbr/openpbr_file.h"
#include "models/pm/pm_file.h"
#include "models/su/su_file.h"
