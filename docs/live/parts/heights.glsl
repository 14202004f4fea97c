/* P from discrete data, section 4.1 of the paper: differences of the samples next to the place, interpolated
 * bilinearly. The table has one row and column of samples before its first cell and two behind, so no look-up wraps.
 */
uniform highp sampler2D samples;
uniform vec2 map_k, map_o;   /* samples for each u and w; the sample at (u,w) = 0 */
uniform ivec2 map_cells;     /* after which the map repeats or ends */
uniform bool map_repeats;
uniform float scale, zero;   /* scene units for one unit of the samples; the sample whose height is 0 */
uniform float Pmin, Pmax;

/* The cell of a place, and the place in it, 0..1. */
ivec2 cell_of(vec2 uw, out vec2 f)
{
    vec2 n = vec2(map_cells), x = uw * map_k + map_o;
    x = clamp(map_repeats ? x - floor(x / n) * n : x, vec2(0), n);
    ivec2 c = min(ivec2(x), map_cells - 1);
    f = x - vec2(c);
    return c;
}

float height_at(ivec2 c) { return scale * (texelFetch(samples, c + 1, 0).r - zero); }

/* P alone: four samples. */
float height(vec2 uw)
{
    vec2 f;
    ivec2 c = cell_of(uw, f);
    vec2 q = vec2(height_at(c), height_at(c + ivec2(1, 0)));
    vec2 r = vec2(height_at(c + ivec2(0, 1)), height_at(c + 1));
    vec2 P = q + (r - q) * f.y;
    return P.x + (P.y - P.x) * f.x;
}

vec4 row_of(ivec2 c)
{
    return vec4(height_at(c + ivec2(-1, 0)), height_at(c), height_at(c + ivec2(1, 0)), height_at(c + ivec2(2, 0)));
}

/* P and its partials: sixteen samples. First down the four columns, then across. */
bs_bump bump_at(vec2 uw)
{
    vec2 f;
    ivec2 c = cell_of(uw, f);
    vec4 p = row_of(c + ivec2(0, -1)), q = row_of(c), r = row_of(c + ivec2(0, 1)), s = row_of(c + ivec2(0, 2));
    vec4 above = q - p, here = r - q, below = s - r;
    vec4 P = q + here * f.y;
    vec4 d = (above + here) + (below - above) * f.y;                          /* twice the difference along w */
    vec4 e = (here - above) + ((below - here) - (here - above)) * f.y;        /* the second one */
    float left = P.y - P.x, middle = P.z - P.y, right = P.w - P.z;
    float twist = d.z - d.x, next = d.w - d.y;
    bs_bump b;
    b.P = P.y + middle * f.x;
    b.Pu = ((left + middle) + (right - left) * f.x) * map_k.x / 2.0;
    b.Pw = (d.y + (d.z - d.y) * f.x) * map_k.y / 2.0;
    b.Puu = ((middle - left) + ((right - middle) - (middle - left)) * f.x) * map_k.x * map_k.x;
    b.Puw = (twist + (next - twist) * f.x) * map_k.x * map_k.y / 4.0;
    b.Pww = (e.y + (e.z - e.y) * f.x) * map_k.y * map_k.y;
    vec2 x = uw * map_k + map_o; /* beyond the ends P is level */
    bool in_u = map_repeats || (x.x >= 0.0 && x.x <= float(map_cells.x));
    bool in_w = map_repeats || (x.y >= 0.0 && x.y <= float(map_cells.y));
    b.Pu = in_u ? b.Pu : 0.0;
    b.Puu = in_u ? b.Puu : 0.0;
    b.Pw = in_w ? b.Pw : 0.0;
    b.Pww = in_w ? b.Pww : 0.0;
    b.Puw = in_u && in_w ? b.Puw : 0.0;
    return b;
}
