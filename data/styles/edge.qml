<!DOCTYPE qgis PUBLIC 'http://mrcc.com/qgis.dtd' 'SYSTEM'>
<qgis version="3.22.16" styleCategories="Symbology">
  <renderer-v2 type="RuleRenderer" symbollevels="0" forceraster="0" enableorderby="0">
    <rules key="root">
      <rule key="surveyed" symbol="0" label="Surveyed" filter="&quot;width_source&quot; = &#x27;surveyed&#x27;"/>
      <rule key="tagged" symbol="1" label="Tagged" filter="&quot;width_source&quot; = &#x27;tagged&#x27;"/>
      <rule key="estimated" symbol="2" label="Tagged as estimated" filter="&quot;width_source&quot; = &#x27;estimated&#x27;"/>
      <rule key="from_lanes" symbol="3" label="From number of lanes" filter="&quot;width_source&quot; = &#x27;from_lanes&#x27;"/>
      <rule key="assumed" symbol="4" label="Assumed from class" filter="&quot;width_source&quot; = &#x27;assumed&#x27;"/>
      <rule key="none" symbol="5" label="No width" filter="&quot;width_source&quot; IS NULL"/>
      <rule key="direction" symbol="6" label="Direction of travel" scalemindenom="1" scalemaxdenom="6000"/>
    </rules>
    <symbols>
      <symbol type="line" name="0" alpha="1" clip_to_extent="1" force_rhr="0">
        <layer class="SimpleLine" enabled="1" locked="0" pass="0">
          <Option type="Map">
            <Option type="QString" name="line_color" value="0,60,48,255"/>
            <Option type="QString" name="line_width" value="0.6"/>
            <Option type="QString" name="line_width_unit" value="MM"/>
            <Option type="QString" name="capstyle" value="round"/>
            <Option type="QString" name="joinstyle" value="round"/>
            <Option type="QString" name="offset_unit" value="MM"/>
          </Option>
          <data_defined_properties>
            <Option type="Map">
              <Option type="QString" name="name" value=""/>
              <Option type="Map" name="properties">
                <Option type="Map" name="outlineWidth">
                  <Option type="bool" name="active" value="true"/>
                  <Option type="QString" name="expression" value="(CASE WHEN &quot;highway&quot; LIKE &#x27;motorway%&#x27; OR &quot;highway&quot; LIKE &#x27;trunk%&#x27; THEN 0.8 WHEN &quot;highway&quot; LIKE &#x27;primary%&#x27; OR &quot;highway&quot; LIKE &#x27;secondary%&#x27; THEN 0.6 ELSE 0.45 END) * scale_exp(@map_scale, 5000, 250000, 2.2, 0.6, 0.5)"/>
                  <Option type="int" name="type" value="3"/>
                </Option>
                <Option type="Map" name="offset">
                  <Option type="bool" name="active" value="true"/>
                  <Option type="QString" name="expression" value="CASE WHEN &quot;oneway&quot; = &#x27;no&#x27; THEN if(&quot;left_hand_traffic&quot;, -0.53, 0.53) * (CASE WHEN &quot;highway&quot; LIKE &#x27;motorway%&#x27; OR &quot;highway&quot; LIKE &#x27;trunk%&#x27; THEN 0.8 WHEN &quot;highway&quot; LIKE &#x27;primary%&#x27; OR &quot;highway&quot; LIKE &#x27;secondary%&#x27; THEN 0.6 ELSE 0.45 END) * scale_exp(@map_scale, 5000, 250000, 2.2, 0.6, 0.5) ELSE 0 END"/>
                  <Option type="int" name="type" value="3"/>
                </Option>
              </Option>
              <Option type="QString" name="type" value="collection"/>
            </Option>
          </data_defined_properties>
        </layer>
      </symbol>
      <symbol type="line" name="1" alpha="1" clip_to_extent="1" force_rhr="0">
        <layer class="SimpleLine" enabled="1" locked="0" pass="0">
          <Option type="Map">
            <Option type="QString" name="line_color" value="1,102,94,255"/>
            <Option type="QString" name="line_width" value="0.6"/>
            <Option type="QString" name="line_width_unit" value="MM"/>
            <Option type="QString" name="capstyle" value="round"/>
            <Option type="QString" name="joinstyle" value="round"/>
            <Option type="QString" name="offset_unit" value="MM"/>
          </Option>
          <data_defined_properties>
            <Option type="Map">
              <Option type="QString" name="name" value=""/>
              <Option type="Map" name="properties">
                <Option type="Map" name="outlineWidth">
                  <Option type="bool" name="active" value="true"/>
                  <Option type="QString" name="expression" value="(CASE WHEN &quot;highway&quot; LIKE &#x27;motorway%&#x27; OR &quot;highway&quot; LIKE &#x27;trunk%&#x27; THEN 0.8 WHEN &quot;highway&quot; LIKE &#x27;primary%&#x27; OR &quot;highway&quot; LIKE &#x27;secondary%&#x27; THEN 0.6 ELSE 0.45 END) * scale_exp(@map_scale, 5000, 250000, 2.2, 0.6, 0.5)"/>
                  <Option type="int" name="type" value="3"/>
                </Option>
                <Option type="Map" name="offset">
                  <Option type="bool" name="active" value="true"/>
                  <Option type="QString" name="expression" value="CASE WHEN &quot;oneway&quot; = &#x27;no&#x27; THEN if(&quot;left_hand_traffic&quot;, -0.53, 0.53) * (CASE WHEN &quot;highway&quot; LIKE &#x27;motorway%&#x27; OR &quot;highway&quot; LIKE &#x27;trunk%&#x27; THEN 0.8 WHEN &quot;highway&quot; LIKE &#x27;primary%&#x27; OR &quot;highway&quot; LIKE &#x27;secondary%&#x27; THEN 0.6 ELSE 0.45 END) * scale_exp(@map_scale, 5000, 250000, 2.2, 0.6, 0.5) ELSE 0 END"/>
                  <Option type="int" name="type" value="3"/>
                </Option>
              </Option>
              <Option type="QString" name="type" value="collection"/>
            </Option>
          </data_defined_properties>
        </layer>
      </symbol>
      <symbol type="line" name="2" alpha="1" clip_to_extent="1" force_rhr="0">
        <layer class="SimpleLine" enabled="1" locked="0" pass="0">
          <Option type="Map">
            <Option type="QString" name="line_color" value="63,157,148,255"/>
            <Option type="QString" name="line_width" value="0.6"/>
            <Option type="QString" name="line_width_unit" value="MM"/>
            <Option type="QString" name="capstyle" value="round"/>
            <Option type="QString" name="joinstyle" value="round"/>
            <Option type="QString" name="offset_unit" value="MM"/>
          </Option>
          <data_defined_properties>
            <Option type="Map">
              <Option type="QString" name="name" value=""/>
              <Option type="Map" name="properties">
                <Option type="Map" name="outlineWidth">
                  <Option type="bool" name="active" value="true"/>
                  <Option type="QString" name="expression" value="(CASE WHEN &quot;highway&quot; LIKE &#x27;motorway%&#x27; OR &quot;highway&quot; LIKE &#x27;trunk%&#x27; THEN 0.8 WHEN &quot;highway&quot; LIKE &#x27;primary%&#x27; OR &quot;highway&quot; LIKE &#x27;secondary%&#x27; THEN 0.6 ELSE 0.45 END) * scale_exp(@map_scale, 5000, 250000, 2.2, 0.6, 0.5)"/>
                  <Option type="int" name="type" value="3"/>
                </Option>
                <Option type="Map" name="offset">
                  <Option type="bool" name="active" value="true"/>
                  <Option type="QString" name="expression" value="CASE WHEN &quot;oneway&quot; = &#x27;no&#x27; THEN if(&quot;left_hand_traffic&quot;, -0.53, 0.53) * (CASE WHEN &quot;highway&quot; LIKE &#x27;motorway%&#x27; OR &quot;highway&quot; LIKE &#x27;trunk%&#x27; THEN 0.8 WHEN &quot;highway&quot; LIKE &#x27;primary%&#x27; OR &quot;highway&quot; LIKE &#x27;secondary%&#x27; THEN 0.6 ELSE 0.45 END) * scale_exp(@map_scale, 5000, 250000, 2.2, 0.6, 0.5) ELSE 0 END"/>
                  <Option type="int" name="type" value="3"/>
                </Option>
              </Option>
              <Option type="QString" name="type" value="collection"/>
            </Option>
          </data_defined_properties>
        </layer>
      </symbol>
      <symbol type="line" name="3" alpha="1" clip_to_extent="1" force_rhr="0">
        <layer class="SimpleLine" enabled="1" locked="0" pass="0">
          <Option type="Map">
            <Option type="QString" name="line_color" value="127,191,176,255"/>
            <Option type="QString" name="line_width" value="0.6"/>
            <Option type="QString" name="line_width_unit" value="MM"/>
            <Option type="QString" name="capstyle" value="round"/>
            <Option type="QString" name="joinstyle" value="round"/>
            <Option type="QString" name="offset_unit" value="MM"/>
          </Option>
          <data_defined_properties>
            <Option type="Map">
              <Option type="QString" name="name" value=""/>
              <Option type="Map" name="properties">
                <Option type="Map" name="outlineWidth">
                  <Option type="bool" name="active" value="true"/>
                  <Option type="QString" name="expression" value="(CASE WHEN &quot;highway&quot; LIKE &#x27;motorway%&#x27; OR &quot;highway&quot; LIKE &#x27;trunk%&#x27; THEN 0.8 WHEN &quot;highway&quot; LIKE &#x27;primary%&#x27; OR &quot;highway&quot; LIKE &#x27;secondary%&#x27; THEN 0.6 ELSE 0.45 END) * scale_exp(@map_scale, 5000, 250000, 2.2, 0.6, 0.5)"/>
                  <Option type="int" name="type" value="3"/>
                </Option>
                <Option type="Map" name="offset">
                  <Option type="bool" name="active" value="true"/>
                  <Option type="QString" name="expression" value="CASE WHEN &quot;oneway&quot; = &#x27;no&#x27; THEN if(&quot;left_hand_traffic&quot;, -0.53, 0.53) * (CASE WHEN &quot;highway&quot; LIKE &#x27;motorway%&#x27; OR &quot;highway&quot; LIKE &#x27;trunk%&#x27; THEN 0.8 WHEN &quot;highway&quot; LIKE &#x27;primary%&#x27; OR &quot;highway&quot; LIKE &#x27;secondary%&#x27; THEN 0.6 ELSE 0.45 END) * scale_exp(@map_scale, 5000, 250000, 2.2, 0.6, 0.5) ELSE 0 END"/>
                  <Option type="int" name="type" value="3"/>
                </Option>
              </Option>
              <Option type="QString" name="type" value="collection"/>
            </Option>
          </data_defined_properties>
        </layer>
      </symbol>
      <symbol type="line" name="4" alpha="1" clip_to_extent="1" force_rhr="0">
        <layer class="SimpleLine" enabled="1" locked="0" pass="0">
          <Option type="Map">
            <Option type="QString" name="line_color" value="216,179,101,255"/>
            <Option type="QString" name="line_width" value="0.6"/>
            <Option type="QString" name="line_width_unit" value="MM"/>
            <Option type="QString" name="capstyle" value="round"/>
            <Option type="QString" name="joinstyle" value="round"/>
            <Option type="QString" name="offset_unit" value="MM"/>
          </Option>
          <data_defined_properties>
            <Option type="Map">
              <Option type="QString" name="name" value=""/>
              <Option type="Map" name="properties">
                <Option type="Map" name="outlineWidth">
                  <Option type="bool" name="active" value="true"/>
                  <Option type="QString" name="expression" value="(CASE WHEN &quot;highway&quot; LIKE &#x27;motorway%&#x27; OR &quot;highway&quot; LIKE &#x27;trunk%&#x27; THEN 0.8 WHEN &quot;highway&quot; LIKE &#x27;primary%&#x27; OR &quot;highway&quot; LIKE &#x27;secondary%&#x27; THEN 0.6 ELSE 0.45 END) * scale_exp(@map_scale, 5000, 250000, 2.2, 0.6, 0.5)"/>
                  <Option type="int" name="type" value="3"/>
                </Option>
                <Option type="Map" name="offset">
                  <Option type="bool" name="active" value="true"/>
                  <Option type="QString" name="expression" value="CASE WHEN &quot;oneway&quot; = &#x27;no&#x27; THEN if(&quot;left_hand_traffic&quot;, -0.53, 0.53) * (CASE WHEN &quot;highway&quot; LIKE &#x27;motorway%&#x27; OR &quot;highway&quot; LIKE &#x27;trunk%&#x27; THEN 0.8 WHEN &quot;highway&quot; LIKE &#x27;primary%&#x27; OR &quot;highway&quot; LIKE &#x27;secondary%&#x27; THEN 0.6 ELSE 0.45 END) * scale_exp(@map_scale, 5000, 250000, 2.2, 0.6, 0.5) ELSE 0 END"/>
                  <Option type="int" name="type" value="3"/>
                </Option>
              </Option>
              <Option type="QString" name="type" value="collection"/>
            </Option>
          </data_defined_properties>
        </layer>
      </symbol>
      <symbol type="line" name="5" alpha="1" clip_to_extent="1" force_rhr="0">
        <layer class="SimpleLine" enabled="1" locked="0" pass="0">
          <Option type="Map">
            <Option type="QString" name="line_color" value="165,171,178,255"/>
            <Option type="QString" name="line_width" value="0.6"/>
            <Option type="QString" name="line_width_unit" value="MM"/>
            <Option type="QString" name="capstyle" value="round"/>
            <Option type="QString" name="joinstyle" value="round"/>
            <Option type="QString" name="offset_unit" value="MM"/>
          </Option>
          <data_defined_properties>
            <Option type="Map">
              <Option type="QString" name="name" value=""/>
              <Option type="Map" name="properties">
                <Option type="Map" name="outlineWidth">
                  <Option type="bool" name="active" value="true"/>
                  <Option type="QString" name="expression" value="(CASE WHEN &quot;highway&quot; LIKE &#x27;motorway%&#x27; OR &quot;highway&quot; LIKE &#x27;trunk%&#x27; THEN 0.8 WHEN &quot;highway&quot; LIKE &#x27;primary%&#x27; OR &quot;highway&quot; LIKE &#x27;secondary%&#x27; THEN 0.6 ELSE 0.45 END) * scale_exp(@map_scale, 5000, 250000, 2.2, 0.6, 0.5)"/>
                  <Option type="int" name="type" value="3"/>
                </Option>
                <Option type="Map" name="offset">
                  <Option type="bool" name="active" value="true"/>
                  <Option type="QString" name="expression" value="CASE WHEN &quot;oneway&quot; = &#x27;no&#x27; THEN if(&quot;left_hand_traffic&quot;, -0.53, 0.53) * (CASE WHEN &quot;highway&quot; LIKE &#x27;motorway%&#x27; OR &quot;highway&quot; LIKE &#x27;trunk%&#x27; THEN 0.8 WHEN &quot;highway&quot; LIKE &#x27;primary%&#x27; OR &quot;highway&quot; LIKE &#x27;secondary%&#x27; THEN 0.6 ELSE 0.45 END) * scale_exp(@map_scale, 5000, 250000, 2.2, 0.6, 0.5) ELSE 0 END"/>
                  <Option type="int" name="type" value="3"/>
                </Option>
              </Option>
              <Option type="QString" name="type" value="collection"/>
            </Option>
          </data_defined_properties>
        </layer>
      </symbol>
      <symbol type="line" name="6" alpha="1" clip_to_extent="1" force_rhr="0">
        <layer class="MarkerLine" enabled="1" locked="0" pass="0">
          <Option type="Map">
            <Option type="QString" name="placement" value="interval"/>
            <Option type="QString" name="interval" value="12"/>
            <Option type="QString" name="interval_unit" value="MM"/>
            <Option type="QString" name="offset_along_line" value="6"/>
            <Option type="QString" name="offset_along_line_unit" value="MM"/>
            <Option type="QString" name="offset_unit" value="MM"/>
            <Option type="QString" name="rotate" value="1"/>
          </Option>
          <data_defined_properties>
            <Option type="Map">
              <Option type="QString" name="name" value=""/>
              <Option type="Map" name="properties">
                <Option type="Map" name="offset">
                  <Option type="bool" name="active" value="true"/>
                  <Option type="QString" name="expression" value="CASE WHEN &quot;oneway&quot; = &#x27;no&#x27; THEN if(&quot;left_hand_traffic&quot;, -0.53, 0.53) * (CASE WHEN &quot;highway&quot; LIKE &#x27;motorway%&#x27; OR &quot;highway&quot; LIKE &#x27;trunk%&#x27; THEN 0.8 WHEN &quot;highway&quot; LIKE &#x27;primary%&#x27; OR &quot;highway&quot; LIKE &#x27;secondary%&#x27; THEN 0.6 ELSE 0.45 END) * scale_exp(@map_scale, 5000, 250000, 2.2, 0.6, 0.5) ELSE 0 END"/>
                  <Option type="int" name="type" value="3"/>
                </Option>
              </Option>
              <Option type="QString" name="type" value="collection"/>
            </Option>
          </data_defined_properties>
          <symbol type="marker" name="@6@0" alpha="1" clip_to_extent="1" force_rhr="0">
            <layer class="SimpleMarker" enabled="1" locked="0" pass="0">
              <Option type="Map">
                <Option type="QString" name="name" value="arrowhead"/>
                <Option type="QString" name="color" value="247,245,240,255"/>
                <Option type="QString" name="outline_color" value="247,245,240,255"/>
                <Option type="QString" name="outline_width" value="0.3"/>
                <Option type="QString" name="outline_width_unit" value="MM"/>
                <Option type="QString" name="size" value="1.3"/>
                <Option type="QString" name="size_unit" value="MM"/>
              </Option>
            </layer>
          </symbol>
        </layer>
      </symbol>
    </symbols>
  </renderer-v2>
</qgis>
