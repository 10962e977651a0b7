// The formulas that read no model, which those of pm.glsl and su.glsl follow.
#include "srbf/kernel/elementary.glsl"
#include "srbf/kernel/gaussian.glsl"
#include "srbf/kernel/vmf.glsl"
#include "srbf/kernel/proposal.glsl"
#include "srbf/kernel/ggx.glsl"
#include "srbf/kernel/openpbr.glsl"
