/* One pixel, by samples x samples rays. */
uniform vec2 picture; /* width and height in pixels */
uniform int samples_side;
layout(location = 0) out vec4 pixel;

void main()
{
    vec3 sum = vec3(0);
    for (int j = 0; j < samples_side; j++)
        for (int i = 0; i < samples_side; i++) {
            vec2 at = floor(gl_FragCoord.xy) + (vec2(i, j) + 0.5) / float(samples_side);
            vec2 p = 2.0 * at / picture - 1.0;
            sum += trace(Ray(eye_from, eye_forward + p.x * eye_right + p.y * eye_up));
        }
    pixel = vec4(srgb(sum / float(samples_side * samples_side)), 1);
}
