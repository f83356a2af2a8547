// What the calls about one instance and those about many have in common.
#pragma once

#include "capi/context.h"

namespace limber::capi {

// `report` may be null. The Def is one that ReadDef gave.
CallStatus SolveInstance(const LimberSolveDef& def, Instance* instance, LimberSolveReport* report);

CallStatus SkinInstance(const LimberSkinDef* def, Instance* instance);

}  // namespace limber::capi
