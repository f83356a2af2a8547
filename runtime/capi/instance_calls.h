// What the calls about one instance and those about many have in common.
#pragma once

#include "capi/context.h"

namespace limber::capi {

// At rest, with the room that `def` says.
CallStatus MakeInstance(const LimberInstanceDef& def, RigEntry* entry,
                        std::unique_ptr<Instance>* instance);

// `report` may be null. The Def is one that ReadDef gave.
CallStatus SolveInstance(const LimberSolveDef& def, Instance* instance, LimberSolveReport* report);

CallStatus SkinInstance(const LimberSkinDef* def, Instance* instance);

// What both that and a pick say where the instance was made without room for skinning.
CallStatus WithoutSkin();

}  // namespace limber::capi
