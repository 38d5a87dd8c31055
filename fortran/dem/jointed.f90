!> What models of jointed rigid bodies have in common, in the plane and in space: their clock, the laws of their joints,
!> their ties, and their contacts without springs.
module dem_jointed
   use dem_clock, only : model_clock
   use dem_joint, only : joint_law
   use dem_places, only : place_table
   use dem_rigid, only : rigid_solver
   use dem_ties, only : tie_set
   implicit none
   private
   public :: jointed_model

   type, extends(model_clock) :: jointed_model
      type(joint_law), allocatable :: law(:)          !! the first is that of contacts that form later
      type(joint_law), allocatable :: own_law(:)      !! while joints are braced: as they are
      type(tie_set) :: ties
      type(rigid_solver) :: rigid                     !! instead of springs where its setting is used
      type(place_table) :: places                     !! contacts whose forces are recorded with their places
   end type jointed_model

end module dem_jointed
