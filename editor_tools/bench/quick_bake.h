// A bake whose weights cost nothing: what is measured after a bake does not depend on how good they
// are.
#pragma once

#include "bake/bake.h"

#include <span>

namespace limber::bench {

// As bake::Bake, with smooth_weights.h in place of the bounded biharmonic weights; no timings, no
// warnings. Handles by source vertex or position, as there.
Result<bake::BakedCharacter> BakeQuickly(const bake::RawCharacter& raw,
                                         std::span<const bake::HandleSpec> handles,
                                         const bake::BakeOptions& options,
                                         const bake::ProgressCallback& progress);

}  // namespace limber::bench
