// limber.h: many instances at once.
#include "capi/context.h"
#include "capi/instance_calls.h"

#include <algorithm>

namespace limber::capi {
namespace {

// What the rounds of one call share. The ids are found and marked before the first round begins.
struct Crowd {
  const char* function = nullptr;
  LimberContext* context = nullptr;
  const LimberInstanceId* instances = nullptr;
  LimberResult* results = nullptr;
  const LimberSolveDef* solve = nullptr;  // read already
  LimberSolveReport* reports = nullptr;
  DefArray<LimberSkinDef> skins = DefArray<LimberSkinDef>(nullptr);
  std::atomic<LimberResult> failure = LIMBER_SUCCESS;  // the first
};

CallStatus SolveOne(const Crowd& crowd, uint32_t i, Instance* instance) {
  return SolveInstance(*crowd.solve, instance,
                       crowd.reports == nullptr ? nullptr : crowd.reports + i);
}

CallStatus SkinOne(const Crowd& crowd, uint32_t i, Instance* instance) {
  return SkinInstance(crowd.skins.At(i), instance);
}

using DoOne = CallStatus (*)(const Crowd&, uint32_t, Instance*);

template <DoOne kDoOne>
void Round(void* data, uint32_t i) {
  Crowd& crowd = *static_cast<Crowd*>(data);
  const LimberResult result =
      CallOn(crowd.context, crowd.function, crowd.instances[i],
             [&](Instance* instance) { return kDoOne(crowd, i, instance); });
  if (crowd.results != nullptr) crowd.results[i] = result;
  if (result == LIMBER_SUCCESS) return;
  LimberResult none = LIMBER_SUCCESS;
  crowd.failure.compare_exchange_strong(none, result, std::memory_order_relaxed);
}

void Unmark(const Crowd& crowd, uint32_t count) {
  for (uint32_t i = 0; i < count; ++i) {
    const LimberInstanceId id = crowd.instances[i];
    if (Instance* instance = crowd.context->instances.Find({id.index, id.generation}))
      instance->in_crowd.store(false, std::memory_order_release);
  }
}

// Each instance belongs to this call alone, and is named once.
CallStatus Mark(const Crowd& crowd, uint32_t count) {
  for (uint32_t i = 0; i < count; ++i) {
    const LimberInstanceId id = crowd.instances[i];
    Instance* instance = crowd.context->instances.Find({id.index, id.generation});
    if (instance == nullptr) continue;  // its own result says so
    if (!instance->in_crowd.exchange(true, std::memory_order_acquire)) continue;
    Unmark(crowd, i);
    return {LIMBER_ERROR_INVALID_ARGUMENT,
            "instances[" + std::to_string(i) + "]: it is there twice, or in another call of now"};
  }
  return {};
}

CallStatus CheckCrowd(const Crowd& crowd, uint32_t count) {
  if (crowd.instances == nullptr && count > 0) return NullArgument("instances");
  if (count <= WorkerPool::kMostRounds) return {};
  return {LIMBER_ERROR_LIMIT_EXCEEDED, "count: " + std::to_string(count) + "; at most " +
                                           std::to_string(WorkerPool::kMostRounds)};
}

// On the host's job system or on the context's own threads.
void RunRounds(LimberContext* context, WorkerPool::Task round, Crowd* crowd, uint32_t count) {
  if (context->def.run_tasks != nullptr) {
    context->def.run_tasks(context->def.tasks_user, round, crowd, count);
  } else {
    Workers(context).Run(round, crowd, count);
  }
}

template <DoOne kDoOne>
LimberResult RunCrowd(Crowd* crowd, uint32_t count) {
  const LimberResult begun = Call(crowd->context, crowd->function, [&]() -> CallStatus {
    LIMBER_RETURN_IF_FAILED(CheckCrowd(*crowd, count));
    // Made here, where a failure to is caught.
    if (crowd->context->def.run_tasks == nullptr) Workers(crowd->context);
    return Mark(*crowd, count);
  });
  if (begun != LIMBER_SUCCESS) return begun;
  RunRounds(crowd->context, Round<kDoOne>, crowd, count);
  Unmark(*crowd, count);
  return crowd->failure.load(std::memory_order_relaxed);
}

}  // namespace

WorkerPool& Workers(LimberContext* context) {
  std::call_once(context->workers_once, [context] {
    const auto cores = static_cast<int32_t>(std::thread::hardware_concurrency());
    const int32_t threads = context->def.num_threads > 0 ? context->def.num_threads : cores;
    context->workers.emplace(static_cast<unsigned>(std::max(0, threads - 1)));
  });
  return *context->workers;
}

}  // namespace limber::capi

using namespace limber;        // NOLINT(google-build-using-namespace): entry points in C's own
using namespace limber::capi;  // NOLINT(google-build-using-namespace)

extern "C" {

LimberResult limberSolveMany(LimberContext* context, const LimberInstanceId* instances,
                             uint32_t count, const LimberSolveDef* def, LimberSolveReport* reports,
                             LimberResult* results) {
  LimberSolveDef full = limberDefaultSolveDef();
  const LimberResult read =
      Call(context, "limberSolveMany", [&] { return ReadDef(def, "LimberSolveDef", &full); });
  if (read != LIMBER_SUCCESS) return read;
  Crowd crowd{"limberSolveMany", context, instances, results, &full, reports};
  return RunCrowd<SolveOne>(&crowd, count);
}

LimberResult limberSkinMany(LimberContext* context, const LimberInstanceId* instances,
                            uint32_t count, const LimberSkinDef* defs, LimberResult* results) {
  if (defs == nullptr && count > 0)
    return Call(context, "limberSkinMany", [] { return NullArgument("defs"); });
  Crowd crowd{"limberSkinMany",
              context,
              instances,
              results,
              nullptr,
              nullptr,
              DefArray<LimberSkinDef>(defs)};
  return RunCrowd<SkinOne>(&crowd, count);
}

}  // extern "C"
