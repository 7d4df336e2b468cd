// Figures that can be watched: the power of the unit of length, and what they are.

import { model } from './state'

export const FIGURES: Record<string, [number, string]> = {
  'mesh.area': [2, 'area of one side of all panels'],
  'mesh.volume': [3, 'volume that the panels enclose'],
  'hydrostatics.volume': [3, 'immersed volume, both sides'],
  'hydrostatics.wetted_area': [2, 'wetted area, both sides'],
  'hydrostatics.draft': [1, 'draught, from the lowest point to the waterplane'],
  'hydrostatics.lcb': [1, 'longitudinal centre of buoyancy'],
  'hydrostatics.tcb': [1, 'transverse centre of buoyancy'],
  'hydrostatics.vcb': [1, 'vertical centre of buoyancy'],
  'hydrostatics.waterplane_area': [2, 'area of the waterplane, both sides'],
  'hydrostatics.lcf': [1, 'longitudinal centre of flotation'],
  'hydrostatics.tcf': [1, 'transverse centre of flotation'],
  'hydrostatics.waterplane_it': [4, 'transverse second moment of the waterplane, about its centre'],
  'hydrostatics.waterplane_il': [4, 'longitudinal second moment of the waterplane, about its centre'],
  'hydrostatics.waterline_low_x': [1, 'end of the waterline at the least x'],
  'hydrostatics.waterline_high_x': [1, 'end of the waterline at the largest x'],
  'hydrostatics.waterline_length': [1, 'length of the waterline'],
  'hydrostatics.waterline_beam': [1, 'breadth of the waterline'],
  'hydrostatics.midship_area': [2, 'area of the midship section below the water'],
  'hydrostatics.bmt': [1, 'transverse metacentre above the centre of buoyancy'],
  'hydrostatics.bml': [1, 'longitudinal metacentre above the centre of buoyancy'],
  'hydrostatics.kmt': [1, 'transverse metacentre above the lowest point'],
  'hydrostatics.kml': [1, 'longitudinal metacentre above the lowest point'],
  'hydrostatics.kb': [1, 'centre of buoyancy above the lowest point'],
  'hydrostatics.cb': [0, 'block coefficient'],
  'hydrostatics.cp': [0, 'prismatic coefficient'],
  'hydrostatics.cm': [0, 'midship coefficient'],
  'hydrostatics.cwp': [0, 'waterplane coefficient'],
}

/** Figures of an object, by their spelling. */
const OF_OBJECTS: [RegExp, number, string][] = [
  [/^volume\([^()]*\)$/, 3, 'volume of the set'],
  [/^mass_centre\([^()]*\)$/, 1, 'centre of the volume'],
  [/^inertia\([^()]*\)\[1\]\.x$/, 5, 'moment of inertia about x through the centre, of density 1'],
  [/^inertia\([^()]*\)\[2\]\.y$/, 5, 'moment of inertia about y through the centre, of density 1'],
  [/^inertia\([^()]*\)\[3\]\.z$/, 5, 'moment of inertia about z through the centre, of density 1'],
  [/^[\w.]+\.volume$/, 3, 'volume that the surface or body encloses'],
  [/^[\w.]+\.area$/, 2, 'area'],
  [/^[\w.]+\.centroid$/, 1, 'centre of the volume of a body, of the area of a surface'],
  [/^[\w.]+\.centre$/, 1, 'centre of mass'],
  [/^[\w.]+\.mass$/, 0, 'mass'],
  [/^[\w.]+\.length$/, 1, 'length of the curve'],
]

/** The power of the unit of length of a figure, and its full name; nothing for other expressions. */
export function figure(expression: string): [number, string] | undefined {
  const own = FIGURES[expression]
  if (own) {
    // The panels of a mirrored model are those of the part that it states.
    const part = { 1: ', one half', 2: ', one quarter', 3: ', one eighth' }[model.mirror.length] ?? ''
    return expression.startsWith('mesh.') ? [own[0], own[1] + part] : own
  }
  const found = OF_OBJECTS.find(([form]) => form.test(expression))
  return found && [found[1], found[2]]
}

/** The unit of a figure in the model's unit of length; nothing for those without one, and for expressions. */
export function unitOf(expression: string): string {
  const power = figure(expression)?.[0] ?? 0
  return power && model.unit ? `${model.unit}${['', '', '²', '³', '⁴', '⁵'][power]}` : ''
}
