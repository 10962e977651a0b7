// All kinds of models.
#pragma once
#include "models/bsdf/bsdf_kind.h"
#include "models/ggx/ggx_kind.h"
#include "models/openpbr/openpbr_kind.h"
#include "models/pm/pm_kind.h"
#include "models/su/su_kind.h"
