/* The compression of OpenEXR's ZIP by libdeflate, and its undoing, where OpenEXR does not use it itself. */
#ifndef KAGE_IMAGE_EXR_ZIP_H
#define KAGE_IMAGE_EXR_ZIP_H

#include <openexr.h>

/* The level for OpenEXR's own compression and ours: three times as fast as zlib's level 4, for half a per cent of size
 * (docs/design.md has the other levels). */
enum { EXR_ZIP_LEVEL = 1 };

/* Give a pipeline that has its routines this compression, and take it back before the pipeline is destroyed. */
exr_result_t exr_zip_begin(exr_encode_pipeline_t *pipe);
void exr_zip_end(exr_encode_pipeline_t *pipe);

/* The same for reading: a pipeline of ZIP or ZIPS gets this decompression, any other stays as it is. The pipeline must
 * free by free(). */
exr_result_t exr_unzip_begin(exr_decode_pipeline_t *pipe);
void exr_unzip_end(exr_decode_pipeline_t *pipe);

#endif
