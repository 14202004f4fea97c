// Figure 4's scene, scenes/cube.yaml, as POV-Ray renders it with a bump_map: the bench's peer for cost.
// (Figure 5's shadow, which follows the bumps, is what POV-Ray has no means for: its shadow rays start on the plane.)
// From the top of the project:
//
//   povray +Ibench/cube_bump_map.pov +W1920 +H1080 +WT1 -A -D -P +Ocube_bump_map.png
//
// The numbers are those of scenes/cube.yaml; a change there belongs here too.
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

// ground. The map's columns run along u = z, its rows, from the first, along w = x, 12 units each, as in the YAML.
// POV-Ray lays an image on 0..1 of x and y, the first row at y = 1, and means it to be seen from -z. So
//     image x  ->  scene  z     image y  ->  scene -x     image z  ->  scene -y
// and the corner of first row and first column comes to the plane's origin, <-6, 0, -6>. This is a rotation:
// POV-Ray makes the bent normal in the image's space, and a mirrored space would turn the bumps inside out.
// bump_size is not a height for POV-Ray but a factor to the difference of neighbouring texels. The YAML's
// 0.22 units from black to white on texels of 12/512 unit make it 0.22 * 512 / 12: the same slopes.
plane {
    y, 0
    pigment { rgb <0.82, 0.72, 0.58> }
    normal {
        bump_map {
            png "scenes/data/bumps.png" gamma 1 // heights, not colours: as they are in the file
            map_type 0                          // flat, and repeated
            interpolate 2                       // bilinear
            bump_size 0.22 * 512 / 12
        }
        matrix <  0,   0, 12,
                -12,   0,  0,
                  0, -12,  0,
                  6,   0, -6>
    }
    finish { ambient 0.12 diffuse 0.8 }
}

// cube
box {
    <-0.6, 0.55, -0.6>, <0.6, 1.75, 0.6>
    pigment { rgb <0.15, 0.3, 0.6> }
    finish { ambient 0.2 diffuse 0.7 phong 0.3 phong_size 30 }
}
