/* Drags a character in C: consumer BAKED.glb prints how far the first handle went. */
#include "frame.h"

#include <stdio.h>
#include <stdlib.h>

static void Check(LimberResult result, const LimberContext* context) {
  char message[512];
  if (result == LIMBER_SUCCESS) return;
  limberGetLastMessage(context, message, sizeof message);
  fprintf(stderr, "%s: %s\n", limberResultString(result), message);
  exit(1);
}

int main(int argc, char** argv) {
  const LimberContextDef def = limberDefaultContextDef();
  LimberContext* context = NULL;
  LimberRigId rig;
  LimberRigInfo info;
  LimberInstanceId instance;
  LimberHandleState handle;
  float target[3];
  Vertex* vertices;
  int frame;
  if (argc < 2) return 2;
  Check(limberCreateContext(&def, &context), context);
  Check(limberLoadRig(context, argv[1], NULL, &rig), context);
  Check(limberGetRigInfo(context, rig, &info), context);
  Check(Spawn(context, rig, &instance), context);
  vertices = calloc(info.num_vertices, sizeof *vertices);
  if (vertices == NULL) return 1;
  Check(limberGetHandle(context, instance, 0, &handle), context);
  target[0] = handle.target[0] + 0.1f * info.diagonal;
  target[1] = handle.target[1];
  target[2] = handle.target[2];
  for (frame = 0; frame < 20; ++frame)
    Check(Frame(context, instance, 0, target, vertices, info.num_vertices), context);
  Check(limberGetHandle(context, instance, 0, &handle), context);
  printf("moved %.3f of the diagonal\n",
         (double)((handle.position[0] + 0.1f * info.diagonal - target[0]) / info.diagonal));
  free(vertices);
  limberDestroyContext(context);
  return 0;
}
