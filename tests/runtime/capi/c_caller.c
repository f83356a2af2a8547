/* A caller in C99, with nothing but the header. */
#include "c_caller.h"

#include "limber/limber.h"

int DragInC(const void* bytes, size_t num_bytes, float moved[3], uint32_t* num_vertices) {
  LimberContextDef context_def = limberDefaultContextDef();
  LimberContext* context = NULL;
  if (limberCreateContext(&context_def, &context) != LIMBER_SUCCESS) return 1;

  LimberRigId rig = {0, 0};
  if (limberLoadRigFromMemory(context, bytes, num_bytes, "from C", NULL, &rig) != LIMBER_SUCCESS)
    return 2;
  LimberRigInfo info;
  if (limberGetRigInfo(context, rig, &info) != LIMBER_SUCCESS) return 3;
  *num_vertices = info.num_vertices;

  LimberInstanceDef instance_def = limberDefaultInstanceDef();
  LimberInstanceId instance = {0, 0};
  if (limberCreateInstance(context, rig, &instance_def, &instance) != LIMBER_SUCCESS) return 4;

  LimberHandleInfo handle;
  if (limberGetHandleInfo(context, rig, 0, &handle) != LIMBER_SUCCESS) return 5;
  for (int i = 0; i < 3; ++i)
    moved[i] = handle.rest_position[i] + 0.1f * info.diagonal;
  if (limberSetTarget(context, instance, 0, moved) != LIMBER_SUCCESS) return 6;
  LimberSolveReport report;
  if (limberSolve(context, instance, NULL, &report) != LIMBER_SUCCESS) return 7;
  limberDestroyContext(context); /* with the rig and the instance */
  return report.iterations == 1 ? 0 : 8;
}
