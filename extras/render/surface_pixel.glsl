// Position and normal of the visible surface at a pixel, as input of pixel.glsl in a second pass. The normal points
// to the viewer; its fourth number is 1 at the front and -1 at the back.
in vec3 surface_position;
in vec3 surface_normal;
layout(location = 0) out vec4 position;
layout(location = 1) out vec4 normal;

void main() {
    position = vec4(surface_position, 1.0);
    float side = gl_FrontFacing ? 1.0 : -1.0;
    normal = vec4(side * surface_normal, side);
}
