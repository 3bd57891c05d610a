<!DOCTYPE qgis PUBLIC 'http://mrcc.com/qgis.dtd' 'SYSTEM'>
<qgis version="3.22.16" styleCategories="Symbology">
  <renderer-v2 type="RuleRenderer" symbollevels="0" forceraster="0" enableorderby="1">
    <rules key="root">
      <rule key="roomy" symbol="0" label="1 m to spare, or more" filter="&quot;rsc_m&quot; &gt;= 1"/>
      <rule key="half" symbol="1" label="0.5 to 1 m to spare" filter="&quot;rsc_m&quot; &gt;= 0.5 AND &quot;rsc_m&quot; &lt; 1"/>
      <rule key="quarter" symbol="2" label="0.25 to 0.5 m to spare" filter="&quot;rsc_m&quot; &gt;= 0.25 AND &quot;rsc_m&quot; &lt; 0.5"/>
      <rule key="tight" symbol="3" label="0 to 0.25 m to spare" filter="&quot;rsc_m&quot; &lt; 0.25"/>
      <rule key="direction" symbol="4" label="Direction of travel" scalemindenom="1" scalemaxdenom="6000"/>
    </rules>
    <symbols>
      <symbol type="line" name="0" alpha="1" clip_to_extent="1" force_rhr="0">
        <layer class="SimpleLine" enabled="1" locked="0" pass="0">
          <Option type="Map">
            <Option type="QString" name="line_color" value="7,40,90,255"/>
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
            <Option type="QString" name="line_color" value="13,76,144,255"/>
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
            <Option type="QString" name="line_color" value="26,111,184,255"/>
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
            <Option type="QString" name="line_color" value="47,147,216,255"/>
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
          <symbol type="marker" name="@4@0" alpha="1" clip_to_extent="1" force_rhr="0">
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
    <orderby>
      <orderByClause asc="0" nullsFirst="0">&quot;rsc_m&quot;</orderByClause>
    </orderby>
  </renderer-v2>
</qgis>
