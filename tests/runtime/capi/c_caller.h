/* What c_caller.c does, for the test that calls it. */
#ifndef LIMBER_TESTS_C_CALLER_H
#define LIMBER_TESTS_C_CALLER_H

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Loads a rig, drags its first handle, takes all down. 0, or the number of the step that failed. */
int DragInC(const void* bytes, size_t num_bytes, float moved[3], uint32_t* num_vertices);

#ifdef __cplusplus
}
#endif

#endif
