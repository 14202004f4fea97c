/* A yardstick of the bench, no part of kage: libpng decodes a grey picture of 16 bits, row by row, and keeps nothing
 * but a sum. Prints the seconds. The bench builds it with the line below.
 *
 *   gcc -O3 png_decode.c -o png_decode -lpng && ./png_decode map.png
 */
#include <png.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

int main(int count, char **word)
{
    FILE *f = count == 2 ? fopen(word[1], "rb") : NULL;
    if (!f) {
        fprintf(stderr, "png_decode: expected a PNG\n");
        return 1;
    }
    struct timespec begin, end;
    clock_gettime(CLOCK_MONOTONIC, &begin);
    png_structp p = png_create_read_struct(PNG_LIBPNG_VER_STRING, NULL, NULL, NULL);
    png_infop info = png_create_info_struct(p);
    png_init_io(p, f);
    png_read_info(p, info);
    png_set_swap(p);
    const size_t bytes = png_get_rowbytes(p, info);
    const unsigned height = png_get_image_height(p, info);
    unsigned char *row = malloc(bytes);
    unsigned long sum = 0;
    for (unsigned y = 0; y < height; y++) {
        png_read_row(p, row, NULL);
        sum += row[0];
    }
    clock_gettime(CLOCK_MONOTONIC, &end);
    printf("decoded %.6f s, sum %lu\n",
           (double)(end.tv_sec - begin.tv_sec) + 1e-9 * (double)(end.tv_nsec - begin.tv_nsec), sum);
    png_destroy_read_struct(&p, &info, NULL);
    free(row);
    fclose(f);
    return 0;
}
