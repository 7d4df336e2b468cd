/* A model in a C program: a parameter, a million points, derivatives and panels.
 *
 *   ln -sf libmoldloft.so ../../target/release/libmoldloft.so.1
 *   cc points.c -I../../crates/capi/include -L../../target/release -lmoldloft -Wl,-rpath,../../target/release -lm -o points
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "moldloft.h"

static void check(int32_t code) {
    if (code == MLF_OK) return;
    size_t length = mlf_v1_message(NULL, 0);
    char *words = malloc(length + 1);
    mlf_v1_message(words, length);
    words[length] = 0;
    fprintf(stderr, "error %d: %s\n", (int)code, words);
    free(words);
    exit(1);
}

int main(void) {
    const char *text =
        "param float beam = 2 in [1, 3];"
        "BCurve keel({{0, 0, 0}, {3, 0, -0.5}, {6, 0, 0}});"
        "BCurve sheer({{0, 0, 1}, {3, beam, 1}, {6, 0, 1}});"
        "RuledSurf side(keel, sheer, divisions = {20, 5});";
    mlf_model *model;
    check(mlf_v1_from_text(text, strlen(text), &model));
    check(mlf_v1_set(model, "beam", 4, 2.5));

    mlf_shape *side;
    check(mlf_v1_shape(model, "side", 4, &side));
    size_t n = 1000000;
    double *uv = malloc(2 * n * sizeof *uv), *xyz = malloc(3 * n * sizeof *xyz);
    for (size_t k = 0; k < n; k++) {
        uv[2 * k] = (double)(k % 1000) / 999;
        uv[2 * k + 1] = (double)(k / 1000) / 999;
    }
    clock_t start = clock();
    check(mlf_v1_points(side, n, uv, xyz));
    double seconds = (double)(clock() - start) / CLOCKS_PER_SEC;
    /* At (0.5, 1): half of the quadratic's middle control point. */
    double at[2] = {0.5, 1}, point[3], slopes[6];
    check(mlf_v1_points(side, 1, at, point));
    check(mlf_v1_slopes(side, 1, at, slopes));
    printf("point %.15g %.15g %.15g\n", point[0], point[1], point[2]);
    printf("by v %.15g %.15g %.15g\n", slopes[3], slopes[4], slopes[5]);

    double area, slope;
    size_t count;
    check(mlf_v1_eval(model, "side.area", 9, &area, 1, &count));
    check(mlf_v1_derivative(model, "side.area", 9, "beam", 4, &slope, 1, &count));
    printf("area %.12g, its derivative by beam %.12g\n", area, slope);

    size_t vertices, panels;
    check(mlf_v1_panel_counts(model, &vertices, &panels));
    double *corners = malloc(3 * vertices * sizeof *corners);
    uint32_t *faces = malloc(4 * panels * sizeof *faces);
    check(mlf_v1_panels(model, corners, faces));
    check(mlf_v1_panel_derivatives(model, "beam", 4, corners));
    printf("%zu vertices, %zu panels\n", vertices, panels);

    check(mlf_v1_add(model, "Line stem({0, 0, 0}, {0, 0, 1});", 32));
    check(mlf_v1_rename(model, "stem", 4, "bow", 3));
    check(mlf_v1_delete(model, "bow", 3));

    /* An error is a code, and the model stays as it was. */
    if (mlf_v1_set(model, "beam", 4, 99) != MLF_MODEL) return 2;
    printf("%zu points in %.3f s\n", n, seconds);
    mlf_v1_shape_free(side);
    mlf_v1_free(model);
    free(uv), free(xyz), free(corners), free(faces);
    return 0;
}
