-- A truck profile for OSRM: its own car profile, reading the tags that speak of heavy goods vehicles first.
-- Put it beside car.lua and its lib/ folder. Dimensions are those of the vehicle that permits were exported for.

local car = require('car')

local function setup()
  local profile = car.setup()
  profile.access_tags_hierarchy = Sequence { 'hgv', 'motor_vehicle', 'vehicle', 'access' }
  profile.restrictions = Sequence { 'hgv', 'motor_vehicle', 'vehicle' }
  profile.vehicle_height = 4.0 -- m
  profile.vehicle_width = 2.55 -- m
  profile.vehicle_length = 16.5 -- m
  profile.vehicle_weight = 40000 -- kg
  profile.vehicle_max_speed = 80 -- km/h
  return profile
end

return {
  setup = setup,
  process_way = car.process_way,
  process_node = car.process_node,
  process_turn = car.process_turn,
}
