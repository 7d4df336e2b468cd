/* The C interface of Moldloft: models in the process of another program.
 *
 * Generated from crates/capi/src/lib.rs by crates/capi/include/generate.py: do not edit.
 *
 * Functions return a code; mlf_v1_message copies the words of the last error of this thread.
 * Texts are UTF-8, pointer and length, without a terminating zero. Arrays are the caller's, and
 * no pointer is kept. A model or shape is used by one thread at a time; freed once.
 */
#ifndef MOLDLOFT_H
#define MOLDLOFT_H

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/* The call succeeded. */
#define MLF_OK 0

/* A pointer is null, or a number of things is wrong. */
#define MLF_ARGUMENT 1

/* The model has an error, or the request to it. */
#define MLF_MODEL 2

/* The buffer is too small; the size that is needed was stored. */
#define MLF_BUFFER 3

/* An error inside the library. */
#define MLF_INTERNAL 99

/* A model. */
typedef struct mlf_model mlf_model;

/* A curve or surface of a model at the time of its request. */
typedef struct mlf_shape mlf_shape;

/* The version of the interface: 1. */
uint32_t mlf_v1_abi(void);

/* Copies the message of the last error of this thread into `buffer` of `size` bytes, without a
 * terminating zero; returns its length in bytes. With a null buffer only the length.
 */
size_t mlf_v1_message(char *buffer, size_t size);

/* Opens the model in a file; `path` has `length` bytes. Free it by mlf_v1_free. */
int32_t mlf_v1_open(const char *path, size_t length, mlf_model **model);

/* Makes a model of a text in the language of `.sdl` files. Free it by mlf_v1_free. */
int32_t mlf_v1_from_text(const char *text, size_t length, mlf_model **model);

/* Frees a model; null does nothing. */
void mlf_v1_free(mlf_model *model);

/* Sets a parameter, or a literal of an object such as `P21.y`. */
int32_t mlf_v1_set(mlf_model *model, const char *name, size_t length, double value);

/* Evaluates an expression: a number, a vector or an array. Stores the numbers at `values`, which
 * has a capacity of `room`, and their number at `count`.
 */
int32_t mlf_v1_eval(mlf_model *model, const char *expression, size_t length, double *values, size_t room, size_t *count);

/* The exact derivative of an expression by a parameter or literal; as mlf_v1_eval. */
int32_t mlf_v1_derivative(mlf_model *model, const char *expression, size_t length, const char *by, size_t by_length, double *values, size_t room, size_t *count);

/* The curve or surface of that name as it is now. Free it by mlf_v1_shape_free. */
int32_t mlf_v1_shape(mlf_model *model, const char *name, size_t length, mlf_shape **shape);

/* Frees a shape; null does nothing. */
void mlf_v1_shape_free(mlf_shape *shape);

/* The number of parameters of a shape: 1 for a curve, 2 for a surface. */
int32_t mlf_v1_shape_parameters(const mlf_shape *shape, size_t *count);

/* Points of a shape: `parameters` holds t, or u and v, of `n` points one after the other; `xyz`
 * takes x, y and z of each. Many points are shared among threads of the library's own.
 */
int32_t mlf_v1_points(const mlf_shape *shape, size_t n, const double *parameters, double *xyz);

/* First derivatives of a shape by its parameters at `n` points, given as for mlf_v1_points: for
 * each point the derivative by t, or those by u and by v, x, y and z of each.
 */
int32_t mlf_v1_slopes(const mlf_shape *shape, size_t n, const double *parameters, double *slopes);

/* The numbers of vertices and of panels of the model as it is. */
int32_t mlf_v1_panel_counts(mlf_model *model, size_t *vertices, size_t *panels);

/* The panels of the model as it is: x, y and z of each vertex, and four vertices of each panel, from
 * 0, counter-clockwise seen from outside; a triangle repeats its last. Either pointer may be null.
 */
int32_t mlf_v1_panels(mlf_model *model, double *xyz, uint32_t *corners);

/* The exact derivatives of all vertices of the panels by a parameter or literal: x, y and z of each. */
int32_t mlf_v1_panel_derivatives(mlf_model *model, const char *by, size_t length, double *xyz);

/* Adds statements to the end of the model's text; the model stays as it was when they are wrong. */
int32_t mlf_v1_add(mlf_model *model, const char *text, size_t length);

/* Gives an object another name, everywhere in the text. */
int32_t mlf_v1_rename(mlf_model *model, const char *name, size_t length, const char *new_name, size_t new_length);

/* Removes an object; refused while others depend on it. */
int32_t mlf_v1_delete(mlf_model *model, const char *name, size_t length);

/* Copies the model's text into `buffer` of `size` bytes, and stores its length at `length`. */
int32_t mlf_v1_text(mlf_model *model, char *buffer, size_t size, size_t *length);

/* Forgets the message of this thread. */
void mlf_v1_clear_message(void);

#ifdef __cplusplus
}
#endif

#endif
