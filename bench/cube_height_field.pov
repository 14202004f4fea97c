// Figures 4 to 7's scene, scenes/cube.yaml, with its bumps as a height_field of POV-Ray: truly displaced, so a peer for cost.
// From the top of the project:
//
//   povray +Ibench/cube_height_field.pov +W640 +H480 +WT1 -A -D -P +Ocube_height_field.png
//
// The numbers are those of scenes/cube.yaml; a change there belongs here too. Triangles between the samples: close to kage's
// bilinear surface, and not the same.
#version 3.7;
global_settings { assumed_gamma 1 } // light and colours are linear, as in kage

camera {
    location <0.2, 4.3, -5.6>
    right x * image_width / image_height // square pixels, before look_at
    angle 37                             // horizontal, as kage's fov
    look_at <0.65, 0.42, 0.15>
}

background { rgb <0.03, 0.04, 0.06> }

light_source { <-4.4, 5.8, -2.6> rgb <1.1, 1.08, 1> }

// ground. The map's columns run along u = z, its rows, from the first, along w = x, 12 units each, as in the YAML. A
// height_field fills the unit cube: image x along x, the last row at z = 0, white at y = 1. Its n samples span n - 1 cells, where
// the YAML's lie in the middle of n cells: hence 511/512 of the size, and half a texel.
#declare Size = 12 * 511 / 512;
#declare Half = 12 / 1024;
height_field {
    png "scenes/data/bumps.png" gamma 1 // heights, not colours: as they are in the file
    matrix <    0,    0, Size,
                0, 0.22,    0,
            -Size,    0,    0,
             6 - Half, -0.22 * 0.417, -6 + Half>
    pigment { rgb <0.82, 0.72, 0.58> }
    finish { ambient 0.12 diffuse 0.8 }
}

// cube
box {
    <-0.6, 0.55, -0.6>, <0.6, 1.75, 0.6>
    pigment { rgb <0.15, 0.3, 0.6> }
    finish { ambient 0.2 diffuse 0.7 phong 0.3 phong_size 30 }
}
