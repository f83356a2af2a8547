/* The README's lines for engines, as consumer.c compiles and runs them. */
/* [the README's lines begin] */
#include <limber/limber.h>

typedef struct Vertex { /* the engine's own */
  float position[3], normal[3], uv[2];
} Vertex;

/* Once a character. A rig may be loaded on any thread while frames run, and serves any number. */
LimberResult Spawn(LimberContext* context, LimberRigId rig, LimberInstanceId* character) {
  return limberCreateInstance(context, rig, NULL, character);
}

/* Each frame: targets in (mesh space), vertices out, straight into the engine's vertex buffer. */
LimberResult Frame(LimberContext* context, LimberInstanceId character, int32_t handle,
                   const float target[3], Vertex* vertices, uint32_t num_vertices) {
  LimberSkinDef skin = limberDefaultSkinDef();
  LimberResult result = limberSetTarget(context, character, handle, target);
  if (result == LIMBER_SUCCESS) result = limberSolve(context, character, NULL, NULL);
  if (result != LIMBER_SUCCESS) return result; /* limberGetLastMessage says why */
  skin.num_vertices = num_vertices;
  skin.positions.data = vertices->position;
  skin.normals.data = vertices->normal;
  skin.positions.stride = skin.normals.stride = sizeof(Vertex);
  return limberSkin(context, character, &skin);
}

/* [the README's lines end] */
