/* How wrong a picture may be, pixel by pixel and as a whole, without knowing the right one.
 *
 * Noise: the picture is the mean of two halves that have nothing random in common.  Half of their
 * difference is then as large as the error of their mean: it has the same distribution, whatever
 * made the noise (photons, pixels, lenses, lamps, gather rays).
 *
 * Bias: the light of photons is blurred.  What half of the area would give less is, in the mean,
 * half of that error (LightEstimate).  One such difference is mostly noise; the product of those
 * of the two halves is not: its mean is the square of the mean difference.  After the idea of
 * Hachisuka, Jarosz, Jensen: A Progressive Error Estimation Framework for Global Illumination,
 * 2010, who find the second derivative of the light from the photons.
 *
 * A picture of a single pass has no halves.  There the noise is made up of what each gathering says
 * of its own photons and rays (LightEstimate), of how the samples of a pixel differ, and where
 * there is one sample, of how its neighbours bend away; the bias is what its blur is above its
 * noise.
 *
 * What settings of the scene cut off (max_trace_level, adc_bailout, the grid of an area light) is
 * taken for right.  SPDX-License-Identifier: Apache-2.0 */
#ifndef PMS_RENDER_ERROR_MAP_H
#define PMS_RENDER_ERROR_MAP_H

#include "render/film_sum.h"

/* Luminances of linear light, of every pixel. */
typedef struct ErrorMap {
    int width, height;
    float *value;     /* of the picture */
    float *luminance; /* the same, averaged over neighbours */
    float *noise;     /* an error as chance may make it, of either sign */
    float *smooth;    /* standard error, from the noise of the pixels around */
    float *shared;    /* as smooth, of the light that samples of a pass share; 0 of a single one */
    float *bias;      /* magnitude */
    float *scratch, *spare; /* to work with */
} ErrorMap;

/* Make a map for films like this one.  Free with error_map_done. */
Status error_map_init(ErrorMap *map, const Film *film, Diag *diag);
void error_map_done(ErrorMap *map);

/* Fill the map for the mean of two sums of the same kind of film, both with passes. */
void error_map_of_halves(const FilmSum halves[2], const Film *film, const SceneSettings *settings,
                         ErrorMap *map);

/* How the samples of a pixel lie: evenly over it, and what they see is sure; or what they see is
 * drawn at random; or each is the mean of rays all over it, as by focal blur, and knows its error.
 */
typedef enum PixelSampling {
    SAMPLED_EVENLY,
    SAMPLED_AT_RANDOM,
    SAMPLED_ALL_OVER
} PixelSampling;

/* Fill the map for a film with clues of a single pass, in working values.
 *
 * samples  of the pixels that have more than one. */
void error_map_of_film(const Film *film, PixelSampling kind, int samples,
                       const SceneSettings *settings, ErrorMap *map);

/* Return the relative standard error of a pixel as those around it tell, without its own samples:
 * for what decides on more of them, else lucky ones would be diluted and unlucky ones kept.
 *
 * mean  luminance of the picture. */
double error_map_around(const ErrorMap *map, size_t pixel, double mean);

/* Return the mean luminance. */
double error_map_mean(const ErrorMap *map);

/* Return the figures of a map. */
ErrorFigure error_figure(const ErrorMap *map);

/* Put the errors into the layers of a picture that show them, and make a picture of them if the
 * options ask for one: made anew, or filled again. */
Status error_map_show(const ErrorMap *map, Image *picture, const RenderOptions *options, Diag *diag,
                      Image *error_picture);

#endif
