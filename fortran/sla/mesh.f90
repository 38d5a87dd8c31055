!> Nodes, their freedoms and the elements between them.
module sla_mesh
   use common_kinds, only : wp
   use sla_group, only : group_holder, material_options, point_group, point_place
   use sla_tables, only : tooth_tables
   use, intrinsic :: iso_c_binding, only : c_int
   implicit none
   private
   public :: element_mesh, is_point

   type :: element_mesh
      integer :: nodes = 0
      integer :: equations = 0                           !! unknown; those of moved supports come after them
      integer :: points = 0                              !! of integration, in all groups
      real(wp), allocatable :: xy(:, :)                  !! (2, nodes) in the plane, (3, nodes) in space [m]
      !> (freedoms of a node, nodes), 0 held, beyond `equations` moved: x, y; of shells x, y, z and the rotations
      integer(c_int), allocatable :: equation(:, :)
      real(wp), allocatable :: factor(:, :)              !! (freedoms of a node, nodes) share of the equation
      type(group_holder), allocatable :: holders(:)
      type(tooth_tables) :: teeth                        !! of the groups that are added next
      type(material_options) :: options
   end type element_mesh

contains

   !> Does the mesh have this point, or is it none?
   pure function is_point(mesh, place) result(yes)
      type(element_mesh), intent(in) :: mesh
      type(point_place), intent(in) :: place     !! group 0: none
      logical :: yes
      yes = place%group == 0
      if (place%group < 1 .or. place%group > size(mesh%holders)) return
      select type (group => mesh%holders(place%group)%group)
      class is (point_group)
         yes = place%point >= 1 .and. place%point <= group%points
      end select
   end function is_point

end module sla_mesh
