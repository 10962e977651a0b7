// The measured material $NAME for Unity (Universal Render Pipeline, Unity 6). NOT RUN in Unity: it was written from Unity's documentation, and
// compiled and drawn with functions that stand in for Unity's.
//
// Put this file into a folder below Assets, and create a material of the shader "Measured/$TITLE (URP)". The project must use linear
// colours (Player Settings).
Shader "Measured/$TITLE (URP)"
{
    Properties
    {
        _Tint ("Tint", Color) = (1, 1, 1, 1)
    }

    SubShader
    {
        Tags { "RenderType" = "Opaque" "RenderPipeline" = "UniversalPipeline" }

        Pass
        {
            Tags { "LightMode" = "UniversalForwardOnly" }  // which the deferred renderer draws too
            HLSLPROGRAM
            #pragma target 4.5
            #pragma vertex vert
            #pragma fragment frag
            #pragma multi_compile _ _MAIN_LIGHT_SHADOWS _MAIN_LIGHT_SHADOWS_CASCADE _MAIN_LIGHT_SHADOWS_SCREEN
            #pragma multi_compile _ _ADDITIONAL_LIGHTS
            #pragma multi_compile _ _FORWARD_PLUS _CLUSTER_LIGHT_LOOP  // of Unity 6.0, and of later versions
            #pragma multi_compile_fragment _ _ADDITIONAL_LIGHT_SHADOWS
            #pragma multi_compile_fragment _ _SHADOWS_SOFT _SHADOWS_SOFT_LOW _SHADOWS_SOFT_MEDIUM _SHADOWS_SOFT_HIGH
            #pragma multi_compile_fog
            #include "Packages/com.unity.render-pipelines.universal/ShaderLibrary/Core.hlsl"
            #include "Packages/com.unity.render-pipelines.universal/ShaderLibrary/Lighting.hlsl"

            CBUFFER_START(UnityPerMaterial)
            float4 _Tint;
            CBUFFER_END
            static float3x3 to_local;  // its rows are the axes of the surface's frame in world space; the last one is the normal

            float3x3 frame_about(float3 n)
            {
                float3 t = normalize(abs(n.y) < 0.9 ? cross(float3(0, 1, 0), n) : cross(float3(1, 0, 0), n));
                return float3x3(t, cross(n, t), n);
            }

            // The environment, filtered as for GGX of this roughness: the reflection probe, or for roughness 1 the ambient light and light
            // probes, whose values are irradiance / pi.
            float3 probe_radiance(float3 direction, float roughness)
            {
                float3 in_world = mul(direction, to_local);
                if (roughness >= 1.0) return max(SampleSH(in_world), 0.0);
                return GlossyEnvironmentReflection(in_world, roughness, 1.0);
            }
            #define $NAME_radiance probe_radiance
$FUNCTIONS

            struct Attributes
            {
                float4 position : POSITION;
                float3 normal : NORMAL;
            };
            struct Interpolated
            {
                float4 pos : SV_POSITION;
                float3 position : TEXCOORD0;  // in world space
                float3 normal : TEXCOORD1;
                float fog : TEXCOORD2;
            };

            Interpolated vert(Attributes v)
            {
                Interpolated o;
                o.position = TransformObjectToWorld(v.position.xyz);
                o.pos = TransformWorldToHClip(o.position);
                o.normal = TransformObjectToWorldNormal(v.normal);
                o.fog = ComputeFogFactor(o.pos.z);
                return o;
            }

            // Unity's own diffuse term lacks 1/pi, therefore the factor pi. `place` has the light's direction or position in `float`; that of
            // Light is in `half`, whose steps show beside a sharp highlight.
            float3 reflected(Light light, float4 place, float3 position, float3 wv)
            {
                float3 wl = mul(to_local, normalize(place.xyz - position * place.w));
                return PI * $NAME_brdf(wl, wv) * max(wl.z, 0.0) * light.color * light.distanceAttenuation * light.shadowAttenuation;
            }
            float3 reflected(uint i, float3 position, float3 wv)
            {
                Light light = GetAdditionalLight(i, position, half4(1, 1, 1, 1));
                #if !defined(_FORWARD_PLUS) && !defined(_CLUSTER_LIGHT_LOOP)
                i = GetPerObjectLightIndex(i);
                #endif
                return reflected(light, _AdditionalLightsPosition[i], position, wv);
            }

            // Unity's loop about the additional lights reads a variable of this name.
            float3 reflected_of_additional(InputData inputData, float3 wv)
            {
                float3 radiance = 0;
                #if defined(_FORWARD_PLUS) || defined(_CLUSTER_LIGHT_LOOP)  // whose loop leaves out directional lights beside the main one
                for (uint i = 0; i < min(URP_FP_DIRECTIONAL_LIGHTS_COUNT, MAX_VISIBLE_LIGHTS); ++i)
                    radiance += reflected(i, inputData.positionWS, wv);
                #endif
                uint count = GetAdditionalLightsCount();
                LIGHT_LOOP_BEGIN(count)
                    radiance += reflected(lightIndex, inputData.positionWS, wv);
                LIGHT_LOOP_END
                return radiance;
            }

            float4 frag(Interpolated i) : SV_Target
            {
                // An interpolated normal may face away from the viewer; it is turned back.
                float3 viewer = normalize(GetWorldSpaceViewDir(i.position)), normal = normalize(i.normal);
                to_local = frame_about(normalize(normal + max(0.01 - dot(normal, viewer), 0.0) * viewer));
                float3 wv = mul(to_local, viewer);
                InputData inputData = (InputData)0;
                inputData.positionWS = i.position;
                inputData.normalizedScreenSpaceUV = GetNormalizedScreenSpaceUV(i.pos);
                #ifdef _MAIN_LIGHT_SHADOWS_SCREEN
                float4 shadow = float4(inputData.normalizedScreenSpaceUV, 0, 1);
                #else
                float4 shadow = TransformWorldToShadowCoord(i.position);
                #endif
                float3 radiance = $NAME_environment(wv) + reflected(GetMainLight(shadow), _MainLightPosition, i.position, wv);
                radiance += reflected_of_additional(inputData, wv);
                return float4(MixFog(_Tint.rgb * radiance, i.fog), 1);
            }
            ENDHLSL
        }

        UsePass "Universal Render Pipeline/Lit/ShadowCaster"
        UsePass "Universal Render Pipeline/Lit/DepthOnly"
        UsePass "Universal Render Pipeline/Complex Lit/DepthNormalsOnly"  // which the deferred renderer draws too
        UsePass "Universal Render Pipeline/Lit/MotionVectors"
    }
}
